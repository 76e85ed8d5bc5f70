#include "client/residency/needed_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace tessera {
namespace {

/// What each pixel samples, pixel by pixel.
std::set<PageKey> sampled_pages(const PlaneView& view, Extent extent, double bias) {
    std::set<PageKey> pages;
    PageKey last[2];  // neighbouring pixels mostly sample the same pages
    const PlanePoint& eye = view.camera().ground;
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const auto ground = view.ground_at(x + 0.5, y + 0.5);
            if (!ground || std::abs(ground->x) > 1e15 || std::abs(ground->y) > 1e15) continue;
            const PlanePoint at = eye.moved(ground->x, ground->y);
            if (at.x < 0 || at.y < 0 || at.x >= extent.side_texels() || at.y >= extent.side_texels())
                continue;
            const double level =
                std::clamp(view.level_at(x + 0.5, y + 0.5) + bias, 0.0, static_cast<double>(extent.n));
            for (const int upper : {0, 1}) {
                const auto l = static_cast<std::uint8_t>(upper ? std::ceil(level) : std::floor(level));
                const PageKey page{l, static_cast<std::uint32_t>(at.x >> (8 + l)),
                                   static_cast<std::uint32_t>(at.y >> (8 + l))};
                if (page == last[upper] && !pages.empty()) continue;
                last[upper] = page;
                pages.insert(page);
            }
        }
    }
    return pages;
}

Camera random_camera(std::mt19937_64& random, Extent extent) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    Camera camera;
    const auto side = static_cast<double>(extent.side_texels());
    camera.ground = PlanePoint{}.moved(uniform(0, side - 1), uniform(0, side - 1));
    camera.height_texels = std::exp2(uniform(5, 14));
    camera.yaw_degrees = uniform(0, 360);
    camera.pitch_degrees = uniform(-90, 5);
    camera.field_of_view_degrees = uniform(35, 70);
    return camera;
}

TEST(NeededPages, AreAllThatAnyPixelSamplesAndHardlyMore) {
    std::mt19937_64 random{7};
    std::size_t needed_count = 0, sampled_count = 0;
    for (int i = 0; i < 36; ++i) {
        const Extent extent{static_cast<std::uint8_t>(i % 4 == 0 ? 3 : i % 4 == 1 ? 30 : 12)};
        const PlaneView view{random_camera(random, extent), 800, 700};
        const double bias = i % 3 == 0 ? 0.75 : 0.0;
        std::set<PageKey> needed;
        for (const NeededPage& page : needed_pages(view, extent, bias)) {
            EXPECT_TRUE(extent.contains(page.key));
            EXPECT_TRUE(needed.insert(page.key).second) << "a page twice";
        }
        const std::set<PageKey> sampled = sampled_pages(view, extent, bias);
        for (const PageKey page : sampled)
            EXPECT_TRUE(needed.contains(page)) << "camera " << i << ": level " << int{page.level} << " page "
                                               << page.x << ',' << page.y << " is sampled and not needed";
        needed_count += needed.size();
        sampled_count += sampled.size();
    }
    EXPECT_GE(static_cast<double>(sampled_count), 0.9 * static_cast<double>(needed_count));
}

/// The pages that the middles of footprints lie in, on the levels that are read, pixel by pixel, by the
/// shaders' formulas.
std::set<PageKey> footprint_pages(const PlaneView& view, Extent extent, const Sampling& sampling) {
    std::set<PageKey> pages;
    const PlanePoint& eye = view.camera().ground;
    for (int y = 0; y < view.height(); y += 2) {
        for (int x = 0; x < view.width(); x += 2) {
            std::array<GroundPoint, 4> corners;
            const auto middle = view.ground_at(x + 0.5, y + 0.5);
            bool is_seen = middle.has_value();
            for (std::size_t i = 0; i < 4; ++i) {
                const auto at = view.ground_at(x + (i == 1 || i == 2), y + static_cast<double>(i / 2));
                is_seen = is_seen && at && std::abs(at->x) < 1e14 && std::abs(at->y) < 1e14;
                if (is_seen) corners[i] = *at;
            }
            if (!is_seen) continue;
            const auto& [a, b, c, d] = corners;
            const auto [left, right] = std::minmax({a.x, b.x, c.x, d.x});
            const auto [top, bottom] = std::minmax({a.y, b.y, c.y, d.y});
            double finest = 0, coarsest = 0;
            if (sampling.kind == Sampling::Kind::line_integral) {
                const double wide = right - left, high = bottom - top;
                if (std::min(wide, high) < 2) continue;  // grown to a texel: another formula
                const double exact = std::log2(
                    line_integral_column(std::min(wide, high), std::max(wide, high), sampling.columns));
                if (std::abs(exact - std::round(exact)) < 0.01) continue;  // either level is right
                finest = coarsest = std::ceil(exact);
            } else {
                const double longer = std::exp2(view.level_at(x + 0.5, y + 0.5));
                const double shorter =
                    std::min(longer, std::hypot(b.x + c.x - a.x - d.x, b.y + c.y - a.y - d.y) / 2);
                const double ratio = longer / shorter;
                if (std::abs(ratio - std::round(ratio)) < 0.01) continue;  // either count is right
                const double probes = std::min(std::ceil(ratio), most_anisotropy);
                finest = std::floor(std::log2(longer / probes));
                coarsest = finest + 1;
            }
            for (double l = std::clamp(finest, 0.0, static_cast<double>(extent.n));
                 l <= std::clamp(coarsest, 0.0, static_cast<double>(extent.n)); ++l) {
                const auto level = static_cast<std::uint8_t>(l);
                const PlanePoint at = eye.moved(middle->x, middle->y);
                if (at.x < 0 || at.y < 0 || at.x >= extent.side_texels() || at.y >= extent.side_texels())
                    continue;
                pages.insert({level, static_cast<std::uint32_t>(at.x >> (8 + level)),
                              static_cast<std::uint32_t>(at.y >> (8 + level))});
            }
        }
    }
    return pages;
}

TEST(NeededPages, OfLongFootprintsAreAllThatAnyPixelReadsAndNotManyMore) {
    std::mt19937_64 random{11};
    for (const Sampling sampling :
         {Sampling{Sampling::Kind::anisotropic, 1}, Sampling{Sampling::Kind::driver_anisotropic},
          Sampling{Sampling::Kind::line_integral, 1, 6}, Sampling{Sampling::Kind::line_integral, 1, 2}}) {
        std::size_t needed_count = 0, read_count = 0, missed = 0;
        for (int i = 0; i < 12; ++i) {
            const Extent extent{static_cast<std::uint8_t>(i % 3 == 0 ? 4 : i % 3 == 1 ? 30 : 12)};
            const PlaneView view{random_camera(random, extent), 400, 350};
            std::set<PageKey> needed;
            for (const NeededPage& page : needed_pages(view, extent, 0, sampling)) {
                EXPECT_TRUE(extent.contains(page.key));
                EXPECT_TRUE(needed.insert(page.key).second) << "a page twice";
            }
            const std::set<PageKey> read = footprint_pages(view, extent, sampling);
            for (const PageKey page : read) {
                if (needed.contains(page)) continue;
                ++missed;
                ADD_FAILURE() << "camera " << i << " pitch " << view.camera().pitch_degrees << ": level "
                              << int{page.level} << " of " << int{extent.n} << ", page " << page.x << ','
                              << page.y << " eye " << (view.camera().ground.x >> (8 + page.level)) << ','
                              << (view.camera().ground.y >> (8 + page.level));
            }
            needed_count += needed.size();
            read_count += read.size();
        }
        std::cout << read_count << " pages read, " << needed_count << " asked for, " << missed << " missed\n";
        EXPECT_EQ(missed, 0u);
        // Every fourth pixel was looked at, if its level is beyond doubt, and of these the middle only
        EXPECT_GE(static_cast<double>(read_count), 0.7 * static_cast<double>(needed_count));
    }
}

TEST(NeededPages, CoverThePictureOnceForEachOfTheTwoLevels) {
    const Camera camera{.ground = {1 << 20, 1 << 20, 0, 0}, .height_texels = 900, .pitch_degrees = -90};
    double pixels = 0;
    for (const NeededPage& page : needed_pages(PlaneView{camera, 800, 700}, Extent{20}, 0))
        pixels += page.pixels;
    EXPECT_NEAR(pixels, 2 * 800.0 * 700.0, 0.02 * 800 * 700);
}

TEST(NeededPages, OfOneEyeAreAFewDozen) {
    for (const double pitch : {-90.0, -40.0, -25.0, -12.0, -1.0}) {
        const Camera camera{
            .ground = {123456789, 987654321, 0.5, 0.5}, .height_texels = 750, .pitch_degrees = pitch};
        const auto needed = needed_pages(PlaneView{camera, 800, 700}, Extent{30}, 0);
        EXPECT_GE(needed.size(), 8u);
        EXPECT_LE(needed.size(), 80u) << pitch;
    }
}

}  // namespace
}  // namespace tessera
