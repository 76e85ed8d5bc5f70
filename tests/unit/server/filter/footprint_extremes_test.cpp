#include <chrono>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>

#include "server/filter/footprint_sampler.h"
#include "tests/unit/server/filter/made_texels.h"

namespace tessera {
namespace {

constexpr std::int64_t far_out = std::int64_t{1} << 38;

/// White where exactly one of x and y is negative, else black: every level shows it without mixing the two,
/// so a footprint's truth is the part of its area on two quadrants.
class Quadrants final : public TexelPages {
  public:
    Quadrants() {
        black_->steps.assign(4 * 256 * 256, 0);
        white_->steps.assign(4 * 256 * 256, 65535);
    }
    Result<std::shared_ptr<const TexelPage>> page(std::uint8_t, std::int64_t x, std::int64_t y, std::int64_t,
                                                  const Budget&) const override {
        return std::shared_ptr<const TexelPage>{(x < 0) != (y < 0) ? white_ : black_};
    }
    std::size_t memory_bytes() const noexcept override { return 0; }

  private:
    std::shared_ptr<TexelPage> black_ = std::make_shared<TexelPage>(), white_ = std::make_shared<TexelPage>();
};

double white_part(const Footprint& f) {
    ConvexPolygon whole, half, quarter;
    for (const TexelPoint& p : f.corners) whole.corners[whole.count++] = p;
    const auto area = [](const ConvexPolygon& p) {
        double sum = 0;
        for (int k = 1; k + 1 < p.count; ++k) {
            const TexelPoint o = p.corners[0], a = p.corners[k], b = p.corners[k + 1];
            sum += (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
        }
        return std::fabs(sum) / 2;
    };
    const auto x = static_cast<double>(-f.x), y = static_cast<double>(-f.y);
    cut<true, false>(whole, x, half);
    cut<false, true>(half, y, quarter);
    double white = area(quarter);
    cut<true, true>(whole, x, half);
    cut<false, false>(half, y, quarter);
    return (white + area(quarter)) / area(whole);
}

TEST(FootprintExtremes, EveryBorderOfPagesHoldsAtEveryLevel) {
    const auto pages = std::make_shared<Quadrants>();
    RandomFootprints random{11};
    double worst = 0;
    for (const FootprintFilter& filter : compared_filters()) {
        const auto sampler = make_sampler(filter, pages);
        for (int level = 0; level <= 30; ++level)
            for (int i = 0; i < 6; ++i) {
                Footprint f = random.next(0, 0, 200);
                for (TexelPoint& p : f.corners)
                    p = {p.x * std::ldexp(1.0, level), p.y * std::ldexp(1.0, level)};
                // The same footprint, counted from elsewhere
                const std::int64_t by = i % 2 == 0 ? 0 : (std::int64_t{1} << level) * 77;
                f.x -= by;
                for (TexelPoint& p : f.corners) p.x += static_cast<double>(by);
                const double truth = white_part(f);
                const FilteredSample sample = sample_one(*sampler, f);
                const double error = furthest(sample, {truth, truth, truth, truth});
                ASSERT_LE(error, sample.bound_codes) << name_of(filter) << " level " << level;
                if (filter.kind == FilterKind::exact ||
                    (filter.kind == FilterKind::line_integral && filter.lines == 0))
                    worst = std::max(worst, error);
            }
    }
    std::printf("exact and unlimited lines at borders of all levels: %.6f codes at most\n", worst);
    EXPECT_LT(worst, 0.001);
}

TEST(FootprintExtremes, ADistanceOfWholePeriodsChangesNoBit) {
    const auto pages = pages_of_image(noise_image(256, 128, 12), Beyond::repeat);
    RandomFootprints random{13};
    for (const FootprintFilter& filter : compared_filters()) {
        if (filter.kind == FilterKind::supersampling_jittered) continue;  // Draws other points elsewhere
        const auto sampler = make_sampler(filter, pages);
        for (int i = 0; i < 12; ++i) {
            Footprint f = random.next(-7, 250, i < 9 ? 150 : 1e5);
            const FilteredSample here = sample_one(*sampler, f);
            for (const std::int64_t by : {far_out, -far_out, 4 * far_out, -4 * far_out}) {
                f.x = -7 + (by > 0 ? by - (by == 4 * far_out ? 256 * 2048 : 0) : by + 256 * 2048);
                f.y = 250 - by / 2;
                const FilteredSample there = sample_one(*sampler, f);
                if (i < 9) {
                    ASSERT_EQ(here.color, there.color) << name_of(filter) << " by " << by;
                }
                for (std::size_t c = 0; c < 4; ++c)
                    ASSERT_NEAR(here.color[c], there.color[c], (here.bound_codes + there.bound_codes) / 255)
                        << name_of(filter);
            }
        }
    }
}

TEST(FootprintExtremes, APointIsItsTexelAndASegmentTheAverageAlongIt) {
    const auto pages = pages_of_image(noise_image(64, 64, 14), Beyond::repeat);
    const auto exact = make_sampler({.kind = FilterKind::exact}, pages);
    const auto nearest = make_sampler({.kind = FilterKind::nearest}, pages);
    for (const std::int64_t x : {std::int64_t{0}, std::int64_t{-1}, far_out + 5}) {
        const Footprint point = footprint_around(x, 3 - x, {0.25, 0.75}, {}, {});
        EXPECT_EQ(sample_one(*exact, point).color, sample_one(*nearest, point).color);
        // Half of its length in each of two texels, whichever way it runs
        const Footprint segment = footprint_around(x, 3, {1, 0.5}, {1.5, 0}, {});
        const auto left = sample_one(*exact, footprint_around(x, 3, {0.5, 0.5}, {}, {})).color,
                   right = sample_one(*exact, footprint_around(x, 3, {1.5, 0.5}, {}, {})).color;
        for (std::size_t c = 0; c < 4; ++c)
            EXPECT_NEAR(sample_one(*exact, segment).color[c], (left[c] + right[c]) / 2, 1e-6F);
    }
    RandomFootprints random{15};
    for (const FootprintFilter& filter : compared_filters()) {
        const auto sampler = make_sampler(filter, pages);
        for (int i = 0; i < 20; ++i) {
            const double length = std::pow(10.0, 6 * random.uniform() - 1);
            const Footprint segment =
                footprint_around(i, -i, {}, {length * random.uniform(), length * random.uniform()}, {});
            const FilteredSample truth = sample_one(*exact, segment), sample = sample_one(*sampler, segment);
            for (std::size_t c = 0; c < 4; ++c)
                ASSERT_LE(std::fabs(sample.color[c] - truth.color[c]) * 255,
                          sample.bound_codes + truth.bound_codes)
                    << name_of(filter) << ' ' << length;
        }
    }
}

TEST(FootprintExtremes, ARatioOfABillionAndFootprintsBeyondTheTextureAreCheapAndBounded) {
    // Rows of one colour each: a footprint along a row has that colour, one across rows their mean
    LinearImage image{32, 32};
    for (std::int32_t y = 0; y < 32; ++y)
        for (std::int32_t i = 0; i < 4 * 32; ++i) image.row(y)[i] = static_cast<float>(y * 2048) / 65535.0F;
    const auto pages = pages_of_image(image, Beyond::repeat);
    constexpr double mean = 31 * 1024 / 65535.0;
    for (const FootprintFilter& filter : compared_filters()) {
        const auto sampler = make_sampler(filter, pages);
        const auto began = std::chrono::steady_clock::now();
        for (const double turn : {0.0, 1.0}) {
            // A texel wide, 10^9 long
            const Footprint sliver =
                footprint_around(-far_out, 16, {0.5, 0.5}, {1e9 * (1 - turn), 1e9 * turn}, {turn, 1 - turn});
            const double truth = turn == 0 ? 16 * 2048 / 65535.0 : mean;
            const FilteredSample sample = sample_one(*sampler, sliver);
            EXPECT_LE(furthest(sample, {truth, truth, truth, truth}), sample.bound_codes) << name_of(filter);
        }
        for (const double side : {std::ldexp(1.0, 20), std::ldexp(1.0, 38), std::ldexp(1.0, 40)}) {
            const Footprint whole = footprint_around(0, 0, {}, {side, side / 3}, {-side / 3, side});
            const FilteredSample sample = sample_one(*sampler, whole);
            const double error = furthest(sample, {mean, mean, mean, mean});
            EXPECT_LE(error, sample.bound_codes) << name_of(filter) << ' ' << side;
            if (filter.kind == FilterKind::exact) {
                EXPECT_LT(error, 0.01);
                EXPECT_LT(sample.bound_codes, 0.5);
            }
        }
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
        EXPECT_LT(took.count(), 10) << name_of(filter);  // A loaded machine; alone it takes some milliseconds
    }
}

TEST(FootprintExtremes, TheSameBytesInAnyOrderWithAnyMemoryAndNumberOfThreads) {
    const auto pages = pages_of_image(noise_image(512, 256, 16), Beyond::repeat);
    RandomFootprints random{17};
    std::vector<Footprint> footprints;
    for (int i = 0; i < 60; ++i)
        footprints.push_back(random.next(i * 37 - 500, i * 11 - 200, i < 26 ? 100 : 3000));
    for (const FootprintFilter& filter : compared_filters()) {
        std::vector<FilteredSample> expected(footprints.size());
        ASSERT_TRUE(make_sampler(filter, pages)->sample(footprints, {}, expected));
        std::vector<std::thread> threads;
        std::vector<int> different(4, 0);
        for (std::size_t t = 0; t < different.size(); ++t)
            threads.emplace_back([&, t] {
                const auto sampler = make_sampler(filter, pages, t == 0 ? 0 : std::size_t{64} << 20);
                for (std::size_t k = 0; k < footprints.size(); ++k) {
                    const std::size_t i = (k * (2 * t + 7) + t) % footprints.size();
                    if (footprints.size() % (2 * t + 7) == 0) continue;
                    const FilteredSample sample = sample_one(*sampler, footprints[i]);
                    if (sample.color != expected[i].color || sample.bound_codes != expected[i].bound_codes ||
                        sample.texels != expected[i].texels)
                        ++different[t];
                }
            });
        for (std::thread& thread : threads) thread.join();
        EXPECT_EQ(different, std::vector<int>(4, 0)) << name_of(filter);
    }
}

}  // namespace
}  // namespace tessera
