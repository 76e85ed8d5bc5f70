#include "server/filter/footprint_sampler.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/server/filter/made_texels.h"

namespace tessera {
namespace {

std::vector<FootprintFilter> all_filters() {
    std::vector<FootprintFilter> filters = compared_filters();
    filters.push_back({.kind = FilterKind::anisotropic, .probes = 1});
    filters.push_back({.kind = FilterKind::supersampling_grid, .side = 1});
    filters.push_back({.kind = FilterKind::supersampling_jittered, .side = 3});
    return filters;
}

TEST(FootprintFilter, NamesGoThereAndBack) {
    for (const FootprintFilter& filter : all_filters()) {
        const auto back = filter_named(name_of(filter));
        ASSERT_TRUE(back) << name_of(filter);
        EXPECT_EQ(name_of(*back), name_of(filter));
        EXPECT_EQ(back->kind, filter.kind);
    }
    EXPECT_EQ(name_of({.kind = FilterKind::anisotropic, .probes = 16}), "anisotropic-16");
    EXPECT_EQ(name_of({.kind = FilterKind::line_integral, .lines = 24, .direction = LineDirection::vertical}),
              "line-integral-vertical-24");
    EXPECT_EQ(name_of({.kind = FilterKind::supersampling_jittered, .side = 8}), "supersampling-jittered-8x8");
    for (const char* wrong :
         {"", "Exact", "exact-1", "anisotropic", "anisotropic-", "anisotropic-0", "anisotropic-65",
          "anisotropic-016", "anisotropic--1", "line-integral-", "line-integral-0", "line-integral-best",
          "line-integral-vertical8", "supersampling-grid-8", "supersampling-grid-8x9",
          "supersampling-jittered-x", "supersampling-jittered-257x257", "supersampling-grid-8x8x8"})
        EXPECT_FALSE(filter_named(wrong)) << wrong;
}

TEST(FootprintSampler, ExactAndUnlimitedLinesEqualTheAreaIntegral) {
    const auto pages = pages_of_image(noise_image(512, 512, 1), Beyond::repeat);
    const auto exact = make_sampler({.kind = FilterKind::exact}, pages);
    RandomFootprints footprints{2};
    for (const LineDirection direction :
         {LineDirection::vertical, LineDirection::horizontal, LineDirection::best}) {
        const auto lines = make_sampler({.kind = FilterKind::line_integral, .direction = direction}, pages);
        for (int i = 0; i < 400; ++i) {
            // Around a corner of pages, so that many span two or four
            const Footprint f = footprints.next(256 * (i % 3 - 1), 256 * (i % 5 - 2), 120);
            const auto truth = area_average(*pages, f);
            EXPECT_LT(furthest(sample_one(*exact, f), truth), 1e-4) << i;
            EXPECT_LT(furthest(sample_one(*lines, f), truth), 1e-4) << i << ' ' << area_of(f);
        }
    }
}

TEST(FootprintSampler, NoFilterLeavesItsCertainBound) {
    const auto pages = pages_of_image(noise_image(300, 200, 3), Beyond::clamp);
    RandomFootprints made{4};
    std::vector<Footprint> footprints;
    std::vector<std::array<double, 4>> truths;
    for (int i = 0; i < 1000; ++i) {
        footprints.push_back(made.next(i % 300, i % 200, 80));
        truths.push_back(area_average(*pages, footprints.back()));
    }
    for (const FootprintFilter& filter : all_filters()) {
        std::vector<FilteredSample> samples(footprints.size());
        ASSERT_TRUE(make_sampler(filter, pages)->sample(footprints, {}, samples));
        int beyond = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (furthest(samples[i], truths[i]) > samples[i].bound_codes) ++beyond;
            EXPECT_GT(samples[i].texels, 0u);
        }
        EXPECT_EQ(beyond, 0) << name_of(filter);
    }
}

TEST(FootprintSampler, ConstantsStayConstantToTheLastBit) {
    RandomFootprints footprints{5};
    for (const unsigned code : {1u, 77u, 255u}) {
        const float value = static_cast<float>(code * 257) / 65535.0F;
        const auto pages = pages_of_image(constant_image(64, 32, {value, value / 2, 0, 1}), Beyond::repeat);
        const FilteredSample expected =
            sample_one(*make_sampler({.kind = FilterKind::nearest}, pages), Footprint{});
        EXPECT_EQ(expected.color[0], value);
        for (const FootprintFilter& filter : all_filters()) {
            const auto sampler = make_sampler(filter, pages);
            for (int i = 0; i < 24; ++i) {
                const Footprint f = footprints.next(-3 + i, i * i, i < 20 ? 200 : 1e7);
                ASSERT_EQ(sample_one(*sampler, f).color, expected.color) << name_of(filter) << ' ' << i;
            }
        }
    }
}

TEST(FootprintSampler, RefusesWhatIsNoFootprint) {
    const auto pages = pages_of_image(noise_image(16, 16, 6), Beyond::repeat);
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    std::vector<Footprint> wrong;
    for (const double bad : {nan, infinity, -infinity, 1e300}) {
        wrong.push_back(footprint_around(0, 0, {}, {1, 0}, {0, 1}));
        wrong.back().corners[2].y = bad;
    }
    wrong.push_back(footprint_around(0, 0, {}, {1, 0}, {0, 1}));
    std::swap(wrong.back().corners[1], wrong.back().corners[2]);
    for (const FootprintFilter& filter : all_filters()) {
        const auto sampler = make_sampler(filter, pages);
        for (const Footprint& footprint : wrong) {
            FilteredSample sample;
            const auto said = sampler->sample({&footprint, 1}, {}, {&sample, 1});
            ASSERT_FALSE(said) << name_of(filter);
            EXPECT_EQ(said.error().code, ErrorCode::invalid_input);
        }
        // And goes on as if nothing had been
        EXPECT_TRUE(std::isfinite(sample_one(*sampler, footprint_around(0, 0, {}, {1, 0}, {0, 1})).color[0]));
    }
}

}  // namespace
}  // namespace tessera
