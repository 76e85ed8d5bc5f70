// Pixels and what hands point at: from a pixel to the texel that it shows and back, on every surface.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "client/view/hand_view.h"

namespace tessera {
namespace {

constexpr Extent extent{30};
constexpr int width = 400, height = 300, views = 150, tries = 250;

class HandViewLaws : public ::testing::TestWithParam<Surface::Kind> {
  protected:
    double between(double low, double high) {
        return std::uniform_real_distribution<double>{low, high}(random_);
    }

    /// From anywhere in the extent, a step above the ground up to high above it, in every direction.
    PlaneView any_view() {
        const auto at = [&] { return static_cast<std::int64_t>(between(0.1, 0.9) * 0x1p38); };
        const Camera camera{.ground = {at(), at(), between(0, 1), between(0, 1)},
                            .height_texels = std::exp2(between(4, 14)),
                            .yaw_degrees = between(0, 360),
                            .pitch_degrees = between(-90, 20),
                            .field_of_view_degrees = between(30, 100)};
        Surface surface{.kind = GetParam(), .relief = between(0.2, 3)};
        if (GetParam() == Surface::Kind::corridor) {
            surface = around(surface, camera);
            surface.half_side *= between(0.8, 6);  // so that the eye is not always in its middle
            surface.middle_x += static_cast<std::int64_t>(surface.half_side * between(-0.7, 0.7));
        }
        return {camera, width, height, surface};
    }

    static HandPoint point(const PlaneView& view, const GroundPoint& at) {
        return hand_point(view.camera().ground.moved(at.x, at.y));
    }

    std::mt19937_64 random_{7};
};

TEST_P(HandViewLaws, WhatAPixelShowsIsSeenThere) {
    int met = 0;
    for (int i = 0; i < views; ++i) {
        const PlaneView view = any_view();
        const HandPicture picture{view};
        std::optional<PicturePieces> pieces;
        if (!view.is_plane()) pieces.emplace(view);
        for (int j = 0; j < tries; ++j) {
            const double x = between(0, width), y = between(0, height);
            const auto ground = view.ground_at(x, y);
            const auto at = picture.point_at(x, y, extent);
            // Farther than the extent's side there is nothing
            if (!ground || std::max(std::abs(ground->x), std::abs(ground->y)) > 0x1p38) {
                ASSERT_FALSE(at);
                continue;
            }
            ASSERT_TRUE(at);
            ASSERT_EQ(*at, point(view, *ground));
            // Some sheet has it there, to a thousandth of a pixel
            double nearest = INFINITY;
            for (int sheet = 0; sheet < picture.sheets(); ++sheet) {
                const auto back =
                    pieces ? pieces->pixel_of(ground->x, ground->y, sheet)
                           : picture.pixel_of(
                                 *at, {distance_x(plane_point(*at), view.camera().ground) + ground->x,
                                       distance_y(plane_point(*at), view.camera().ground) + ground->y});
                if (back) nearest = std::min(nearest, std::hypot(back->x - x, back->y - y));
            }
            ASSERT_LT(nearest, 1e-3) << "view " << i << ", pixel " << x << ", " << y << ", texel "
                                     << ground->x << ", " << ground->y;
            ++met;
        }
    }
    EXPECT_GT(met, views * tries / 3);
}

TEST_P(HandViewLaws, WhereATexelIsSeenThatTexelIsPointedAt) {
    int seen = 0, hidden = 0;
    for (int i = 0; i < views; ++i) {
        const PlaneView view = any_view();
        const HandPicture picture{view};
        for (int j = 0; j < tries; ++j) {
            // Around the eye, near ones as often as far ones
            const double away = view.camera().height_texels * std::exp2(between(-4, 6)),
                         angle = between(0, 6.3);
            const HandPoint texel = point(view, {away * std::cos(angle), away * std::sin(angle)});
            bool is_seen = false;
            for (int sheet = 0; sheet < picture.sheets(); ++sheet) {
                const auto pixel = picture.pixel_of(texel, sheet);
                if (!pixel || pixel->x < 0 || pixel->y < 0 || pixel->x >= width || pixel->y >= height)
                    continue;
                const auto at = picture.point_at(pixel->x, pixel->y, extent);
                ASSERT_TRUE(at);
                // To a unit, and a billionth of the distance
                const double most = 1 + 1e-9 * away * sprite_units;
                ASSERT_LE(std::abs(static_cast<double>(at->x - texel.x)), most) << "view " << i;
                ASSERT_LE(std::abs(static_cast<double>(at->y - texel.y)), most) << "view " << i;
                is_seen = true;
            }
            ++(is_seen ? seen : hidden);
        }
    }
    EXPECT_GT(seen, views * tries / 20);
    EXPECT_GT(hidden, views * tries / 20);
}

class OffThePlane : public HandViewLaws {};

/// All that pixels show is in the box of which sprites are asked for, but what is too far away.
TEST_P(OffThePlane, WhatIsNearAndSeenIsAskedFor) {
    for (int i = 0; i < views; ++i) {
        const PlaneView view = any_view();
        const TexelBox box = HandPicture{view}.seen(extent);
        for (int j = 0; j < tries; ++j) {
            const auto ground = view.ground_at(between(0, width), between(0, height));
            const double near = 50 * view.camera().height_texels;
            if (!ground || std::max(std::abs(ground->x), std::abs(ground->y)) > near) continue;
            const PlanePoint at = view.camera().ground.moved(ground->x, ground->y);
            ASSERT_TRUE(at.x >= box.x0 && at.x < box.x1 && at.y >= box.y0 && at.y < box.y1) << "view " << i;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, HandViewLaws,
                         ::testing::Values(Surface::Kind::plane, Surface::Kind::terrain,
                                           Surface::Kind::corridor),
                         [](const auto& one) { return std::string{name_of(one.param)}; });

INSTANTIATE_TEST_SUITE_P(Surfaces, OffThePlane,
                         ::testing::Values(Surface::Kind::terrain, Surface::Kind::corridor),
                         [](const auto& one) { return std::string{name_of(one.param)}; });

}  // namespace
}  // namespace tessera
