// Laws of footprint filters, and their bytes.

#include <bit>
#include <cmath>
#include <cstdio>
#include <map>

#include <gtest/gtest.h>

#include "server/filter/footprint_sampler.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// Random integers and fractions without libm: golden bytes begin with these.
class Draws {
  public:
    explicit Draws(std::uint64_t seed) : seed_{seed} {}
    std::uint64_t bits() { return mix(seed_ + 0x9e3779b97f4a7c15u * ++count_); }
    double between(double from, double to) {
        return from + (to - from) * static_cast<double>(bits() >> 40) * 0x1p-24;
    }

    /// A quadrilateral, often slender, of up to `most` texels' length.
    Footprint footprint(std::int64_t x, std::int64_t y, double most) {
        for (;;) {
            const double shrink = halved(8), length = most * shrink, thin = halved(8);
            const TexelPoint along{between(-length, length), between(-length, length)};
            const TexelPoint across{-along.y * thin + between(-0.1, 0.1) * along.x * thin,
                                    along.x * thin + between(-0.1, 0.1) * along.y * thin};
            Footprint f = footprint_around(x, y, {between(-3, 3), between(-3, 3)}, along, across);
            if (bits() % 2 == 0) {
                const double lean = between(0, 0.4);
                f.corners[1] = {f.corners[1].x + lean * across.x, f.corners[1].y + lean * across.y};
            }
            if (check_footprint(f) && area_of(f) > 0) return f;
        }
    }

  private:
    double halved(std::uint64_t most) { return 1.0 / static_cast<double>(1u << bits() % most); }
    std::uint64_t seed_, count_ = 0;
};

/// The most adverse texture: texels are black or white, with nothing between.
LinearImage black_and_white(std::int32_t side, std::int32_t grain, std::uint64_t seed) {
    LinearImage image{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t i = 0; i < 4 * side; ++i)
            image.row(y)[i] = i % 4 == 3 || hash(seed, 1, i / 4 / grain, y / grain) % 2 == 0 ? 1.0F : 0.0F;
    return image;
}

std::uint64_t hash_of(std::span<const FilteredSample> samples) {
    std::uint64_t h = 0;
    for (const FilteredSample& sample : samples) {
        for (const float v : sample.color) h = mix(h ^ std::bit_cast<std::uint32_t>(v));
        h = mix(h ^ std::bit_cast<std::uint64_t>(sample.bound_codes));
        h = mix(h ^ sample.texels);
    }
    return h;
}

TEST(FootprintLaws, BoundsHoldOnBlackAndWhiteWhateverTheGrain) {
    for (const std::int32_t grain : {1, 2, 16, 64}) {
        const auto pages = pages_of_image(black_and_white(512, grain, 1), Beyond::repeat);
        Draws draws{static_cast<std::uint64_t>(grain)};
        std::vector<Footprint> footprints;
        for (int i = 0; i < 500; ++i)
            footprints.push_back(
                draws.footprint(static_cast<std::int64_t>(draws.bits() % 4096) - 2048, i, 1500));
        std::vector<FilteredSample> truth(footprints.size()), samples(footprints.size());
        ASSERT_TRUE(make_sampler({.kind = FilterKind::exact}, pages)->sample(footprints, {}, truth));
        for (const FootprintFilter& filter : compared_filters()) {
            if (filter.side > 8) continue;
            ASSERT_TRUE(make_sampler(filter, pages)->sample(footprints, {}, samples));
            int beyond = 0;
            for (std::size_t i = 0; i < samples.size(); ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    if (std::fabs(samples[i].color[c] - truth[i].color[c]) * 255 >
                        samples[i].bound_codes + truth[i].bound_codes)
                        ++beyond;
            EXPECT_EQ(beyond, 0) << name_of(filter) << ", grain " << grain;
        }
    }
}

TEST(FootprintLaws, ExactOfATexelOfALevelIsThatTexelOfThePage) {
    const auto pages = pages_of_image(black_and_white(96, 1, 2), Beyond::repeat);
    const auto exact = make_sampler({.kind = FilterKind::exact}, pages);
    double worst = 0;
    for (int level = 0; level <= 30; ++level)
        for (const std::int64_t at : {0, -1, 255, 256, -257}) {
            const std::int64_t x = at * (std::int64_t{1} << level), y = -x;
            const double side = static_cast<double>(std::int64_t{1} << level);
            const Footprint f = footprint_around(x, y, {side / 2, side / 2}, {side, 0}, {0, side});
            FilteredSample sample;
            ASSERT_TRUE(exact->sample({&f, 1}, {}, {&sample, 1}));
            const std::int64_t i = at, j = -at;
            const auto page = pages->page(static_cast<std::uint8_t>(level), i >> 8, j >> 8, 0, {}).value();
            for (std::size_t c = 0; c < 4; ++c) {
                const double texel =
                    page->steps[static_cast<std::size_t>(((j & 255) * 256 + (i & 255)) * 4) + c] / 65535.0;
                const double error = std::fabs(static_cast<double>(sample.color[c]) - texel) * 255;
                worst = std::max(worst, error);
                ASSERT_LE(error, sample.bound_codes + page->bound_codes) << level << ' ' << at;
            }
        }
    std::printf("exact against a page's texel: %.6f codes at most\n", worst);
    EXPECT_LT(worst, 0.004);
}

TEST(FootprintLaws, TheWholeIsTheAverageOfItsParts) {
    const auto pages = pages_of_image(black_and_white(512, 1, 3), Beyond::repeat);
    Draws draws{4};
    for (const FootprintFilter& filter :
         {FootprintFilter{.kind = FilterKind::exact}, FootprintFilter{.kind = FilterKind::line_integral}}) {
        const auto sampler = make_sampler(filter, pages);
        // Exact reads texels of coarser levels, whose steps are rounded
        const double rounding = filter.kind == FilterKind::exact ? 0.5 / 65535 : 2e-7;
        for (int n = 0; n < 300; ++n) {
            const Footprint whole = draws.footprint(n * 31, -n, 600);
            const auto middle = [](TexelPoint a, TexelPoint b) {
                return TexelPoint{(a.x + b.x) / 2, (a.y + b.y) / 2};
            };
            const auto& c = whole.corners;
            Footprint first = whole, second = whole;
            first.corners = {c[0], middle(c[0], c[1]), middle(c[3], c[2]), c[3]};
            second.corners = {middle(c[0], c[1]), c[1], c[2], middle(c[3], c[2])};
            const Footprint three[] = {whole, first, second};
            FilteredSample samples[3];
            ASSERT_TRUE(sampler->sample(three, {}, samples));
            const double share = area_of(first) / area_of(whole);
            EXPECT_NEAR(share * static_cast<double>(samples[1].color[0]) +
                            (1 - share) * static_cast<double>(samples[2].color[0]),
                        static_cast<double>(samples[0].color[0]), rounding)
                << name_of(filter);
        }
    }
}

TEST(FootprintLaws, MoreLinesAreNearerToTheTruth) {
    const auto pages = pages_of_image(black_and_white(1024, 4, 5), Beyond::repeat);
    Draws draws{6};
    std::vector<Footprint> footprints;
    for (int i = 0; i < 800; ++i) footprints.push_back(draws.footprint(i * 17, i, 400));
    std::vector<FilteredSample> truth(footprints.size()), samples(footprints.size());
    ASSERT_TRUE(make_sampler({.kind = FilterKind::exact}, pages)->sample(footprints, {}, truth));
    const auto mse = [&](const FootprintFilter& filter) {
        EXPECT_TRUE(make_sampler(filter, pages)->sample(footprints, {}, samples));
        double sum = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double error = static_cast<double>(samples[i].color[0] - truth[i].color[0]) * 255;
            sum += error * error;
        }
        return sum / static_cast<double>(samples.size());
    };
    double before = mse({.kind = FilterKind::anisotropic, .probes = 16});
    for (const std::int32_t lines : {8, 16, 32, 64, 0}) {
        const double now = mse({.kind = FilterKind::line_integral, .lines = lines});
        EXPECT_LT(now, before) << lines;
        if (lines > 0)
            for (const LineDirection one : {LineDirection::vertical, LineDirection::horizontal}) {
                EXPECT_LT(now, mse({.kind = FilterKind::line_integral, .lines = lines, .direction = one}));
            }
        before = now;
    }
    EXPECT_LT(before, 1e-8);
}

TEST(FootprintLaws, GoldenBytesOfEveryFilter) {
    const auto pages = pages_of_image(black_and_white(256, 3, 7), Beyond::repeat);
    std::map<std::string, std::uint64_t> hashes;
    for (const FootprintFilter& filter : compared_filters()) {
        Draws draws{8};
        std::vector<Footprint> footprints;
        for (const std::int64_t x : {std::int64_t{0}, (std::int64_t{1} << 38) - 5, -(std::int64_t{1} << 40)})
            for (int i = 0; i < 60; ++i) footprints.push_back(draws.footprint(x + i, -i, i < 50 ? 300 : 1e6));
        std::vector<FilteredSample> samples(footprints.size());
        ASSERT_TRUE(make_sampler(filter, pages)->sample(footprints, {}, samples));
        hashes[name_of(filter)] = hash_of(samples);
    }
    const std::map<std::string, std::uint64_t> golden{
        {"anisotropic-16", 0x2de383443a9cb75au},
        {"anisotropic-2", 0x5be502b4c1d27f76u},
        {"anisotropic-4", 0x43025c1b822730dbu},
        {"anisotropic-64", 0xa546ad3ddce14701u},
        {"anisotropic-8", 0xea6d26413c0845dcu},
        {"bilinear", 0x949e14717c16be9cu},
        {"ewa", 0x41ab80d1ad055962u},
        {"exact", 0xa090c3756480dfa4u},
        {"line-integral", 0x8eac178a2cf025e8u},
        {"line-integral-16", 0x26e4fa397aa48b5u},
        {"line-integral-24", 0x6ac250e5d6075951u},
        {"line-integral-4", 0x1f1ff9a1ef744249u},
        {"line-integral-48", 0x455753202c9b085eu},
        {"line-integral-8", 0xb5a4093b3aeb280au},
        {"line-integral-horizontal", 0xfd58efd830ee08abu},
        {"line-integral-horizontal-16", 0x2b3b3abd1e73f64cu},
        {"line-integral-horizontal-24", 0xb7f1a758a57c0559u},
        {"line-integral-horizontal-4", 0xcb228c8add2dfebbu},
        {"line-integral-horizontal-48", 0x975a4e919aa4d9a8u},
        {"line-integral-horizontal-8", 0xf237976e74790557u},
        {"line-integral-vertical", 0x83ff8b26571bd43bu},
        {"line-integral-vertical-16", 0xacf41390015f435bu},
        {"line-integral-vertical-24", 0x8f5baff6f7008794u},
        {"line-integral-vertical-4", 0x18f8dd0e251dfcf2u},
        {"line-integral-vertical-48", 0x5be8358c8ce94cebu},
        {"line-integral-vertical-8", 0x56521d358adbd255u},
        {"nearest", 0x5cae396f928bcc63u},
        {"summed-area", 0x956688e78a8f5088u},
        {"supersampling-grid-16x16", 0xefadd65554c9f7f3u},
        {"supersampling-grid-2x2", 0x43370596ece706cfu},
        {"supersampling-grid-4x4", 0xedadfd86a2cf9849u},
        {"supersampling-grid-8x8", 0x41899128d96feaefu},
        {"supersampling-jittered-16x16", 0x8e7f55a3dfa29cddu},
        {"supersampling-jittered-2x2", 0x2255c0ec4fe38655u},
        {"supersampling-jittered-4x4", 0x11e1e7baa9c20519u},
        {"supersampling-jittered-8x8", 0x46ff5b413eb58274u},
        {"trilinear", 0x65735a2b4bbe563du},
    };
    for (const auto& [name, value] : hashes) {
        const auto found = golden.find(name);
        EXPECT_TRUE(found != golden.end() && found->second == value)
            << "{\"" << name << "\", 0x" << std::hex << value << "u},";
    }
}

}  // namespace
}  // namespace tessera
