#include "shared/math/footprint_from_rays.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace tessera {
namespace {

/// An eye one unit above the ground z = 0, looking `down` against the horizon; one texel is 1/100 unit.
struct View {
    double down = 0.5;    ///< Of the ray through the middle, for each unit forwards.
    double pixel = 0.01;  ///< Between neighbouring rays, for each unit forwards.

    RayDifferentials rays() const {
        RayDifferentials rays{};
        rays.origin = {0, 0, 1};
        rays.direction = {0, 1, -down};
        rays.direction_dx = {pixel, 0, 0};
        rays.direction_dy = {0, 0, -pixel};
        return rays;
    }
    TexturedPlane ground() const {
        TexturedPlane plane{};
        plane.point = {0, down > 0 ? 1 / down : 0, 0};
        plane.per_s = {0.01, 0, 0};
        plane.per_t = {0, -0.01, 0};
        plane.x = std::int64_t{1} << 37;
        plane.y = -5;
        plane.texel = {0.25, -100};
        plane.slice = 3;
        return plane;
    }
    /// Where the ray with so many pixels to the right and below meets the ground, in texels from the hit.
    TexelPoint exact(double right, double below) const {
        const double distance = 1 / (down + below * pixel);
        return {100 * distance * right * pixel, -100 * (distance - 1 / down)};
    }
};

double apart(TexelPoint a, TexelPoint b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(FootprintFromRays, IsWhatAPixelOfAPinholeCameraCoversOfThePlane) {
    for (const double down : {3.0, 0.5, 0.02, 0.00501}) {
        const View view{down};
        const Footprint footprint = footprint_from_rays(view.rays(), view.ground()).value();
        EXPECT_EQ(footprint.x, std::int64_t{1} << 37);
        EXPECT_EQ(footprint.y, -5);
        EXPECT_EQ(footprint.slice, 3);
        const TexelPoint pixel[] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
        for (std::size_t i = down < 0.01 ? 2 : 0; i < 4; ++i) {  // the far corners of the last are drawn back
            const TexelPoint wanted = view.exact(pixel[i].x, pixel[i].y);
            EXPECT_LT(apart(footprint.corners[i], {wanted.x + 0.25, wanted.y - 100}), 1e-9)
                << down << " " << i;
        }
    }
}

TEST(FootprintFromRays, DoesNotDependOnTheLengthOfTheRayOrTheSideOfThePlane) {
    const View view{0.1};
    const Footprint plain = footprint_from_rays(view.rays(), view.ground()).value();
    RayDifferentials longer = view.rays();
    for (WorldVector* v : {&longer.direction, &longer.direction_dx, &longer.direction_dy})
        *v = {v->x * 40, v->y * 40, v->z * 40};
    TexturedPlane skewed = view.ground();  // s and t need not be at right angles
    const Footprint same = footprint_from_rays(longer, skewed).value();
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(apart(plain.corners[i], same.corners[i]), 1e-9);
    skewed.per_t = {0.01, -0.01, 0};  // one texel down goes one to the right as well
    const Footprint sheared = footprint_from_rays(view.rays(), skewed).value();
    for (std::size_t i = 0; i < 4; ++i) {
        const TexelPoint p = plain.corners[i];
        EXPECT_LT(apart({p.x - (p.y + 100), p.y}, sheared.corners[i]), 1e-9);
    }
}

TEST(FootprintFromRays, WithoutDifferentialsHasNoAreaAndLiesAtTheHit) {
    const View view{0.3, 0};
    const Footprint footprint = footprint_from_rays(view.rays(), view.ground()).value();
    EXPECT_EQ(area_of(footprint), 0);
    for (const TexelPoint corner : footprint.corners) EXPECT_LT(apart(corner, {0.25, -100}), 1e-9);
}

TEST(FootprintFromRays, AcrossTheHorizonGoesSoManyTimesAsFarAsTheHitAndNoFurther) {
    for (const double down : {0.004, 0.001, 1e-4}) {  // the upper rays, 0.005 higher, meet nothing
        const View view{down};
        const Footprint footprint = footprint_from_rays(view.rays(), view.ground()).value();
        EXPECT_TRUE(check_footprint(footprint)) << down;
        const double hit = 100 / down;
        double farthest = 0;
        for (const TexelPoint corner : footprint.corners)
            farthest = std::max(farthest, -(corner.y + 100) + hit);
        EXPECT_NEAR(farthest / hit, farthest_multiple, 1e-6) << down;
        EXPECT_GT(area_of(footprint), 0) << down;
        // The near corners are where they are without a horizon
        EXPECT_LT(apart(footprint.corners[2], {view.exact(0.5, 0.5).x + 0.25, view.exact(0.5, 0.5).y - 100}),
                  1e-6);
    }
}

TEST(FootprintFromRays, AlongThePlaneIsAsIfThePlaneWereTurnedALittle) {
    View view{0};
    RayDifferentials rays = view.rays();
    rays.origin = {0, 0, 0};  // in the plane, looking along it
    TexturedPlane plane = view.ground();
    plane.point = {0, 2, 0};
    const auto footprint = footprint_from_rays(rays, plane);
    ASSERT_TRUE(footprint) << footprint.error().detail;
    EXPECT_TRUE(check_footprint(*footprint));
    for (const TexelPoint corner : footprint->corners)
        EXPECT_LE(std::fabs(corner.y + 100), 200 * farthest_multiple);
    // Just above and just below that angle the two ways agree
    const View flat{least_sine * 1.001, 1e-7}, flatter{least_sine * 0.999, 1e-7};
    const double a = area_of(footprint_from_rays(flat.rays(), flat.ground()).value());
    const double b = area_of(footprint_from_rays(flatter.rays(), flatter.ground()).value());
    EXPECT_NEAR(a / b, 1, 0.05);
}

TEST(FootprintFromRays, BehindTheEyeIsRefused) {
    const View view{0.5};
    TexturedPlane plane = view.ground();
    plane.point = {0, -2, 2};  // the plane z = 2 lies above an eye that looks down
    const auto behind = footprint_from_rays(view.rays(), plane);
    ASSERT_FALSE(behind);
    EXPECT_NE(behind.error().detail.find("behind"), std::string::npos);
    plane.point = view.rays().origin;
    EXPECT_FALSE(footprint_from_rays(view.rays(), plane));
}

TEST(FootprintFromRays, HugeDifferentialsStayInRange) {
    for (const double pixel : {2.0, 1e6, 1e15, 1e30}) {
        const View view{0.5, pixel};
        const auto footprint = footprint_from_rays(view.rays(), view.ground());
        ASSERT_TRUE(footprint) << pixel << " " << footprint.error().detail;
        EXPECT_TRUE(check_footprint(*footprint));
        for (const TexelPoint corner : footprint->corners)
            EXPECT_LE(std::max(std::fabs(corner.x), std::fabs(corner.y)), 0x1p39 + 200);
    }
}

TEST(FootprintFromRays, FollowsAnEyeThatMoves) {
    const View view{1, 0};
    RayDifferentials rays = view.rays();  // orthographic: the origin moves, the direction stays
    rays.origin_dx = {0.02, 0, 0};
    rays.origin_dy = {0, 0, -0.02};
    const Footprint footprint = footprint_from_rays(rays, view.ground()).value();
    EXPECT_NEAR(area_of(footprint), 2 * 2, 1e-9);
    EXPECT_LT(apart(footprint.corners[0], {0.25 - 1, -100 - 1}), 1e-9);
    rays.origin_dy = {0, 0, -1e6};  // through the plane and far beyond
    EXPECT_TRUE(footprint_from_rays(rays, view.ground()));
}

TEST(FootprintFromRays, NamesTheFieldThatIsWrong) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    const View view;
    const auto refused = [&](auto change) {
        RayDifferentials rays = view.rays();
        TexturedPlane plane = view.ground();
        change(rays, plane);
        const auto footprint = footprint_from_rays(rays, plane);
        return footprint ? std::string{"taken"}
                         : footprint.error().detail.substr(0, footprint.error().detail.find(':'));
    };
    EXPECT_EQ(refused([&](auto& rays, auto&) { rays.origin.y = nan; }), "origin");
    EXPECT_EQ(refused([&](auto& rays, auto&) { rays.direction_dy.z = infinity; }), "direction_dy");
    EXPECT_EQ(refused([&](auto& rays, auto&) { rays.origin_dx.x = -1e31; }), "origin_dx");
    EXPECT_EQ(refused([&](auto& rays, auto&) { rays.direction = {}; }), "direction");
    EXPECT_EQ(refused([&](auto&, auto& plane) { plane.per_s = {}; }), "per_s");
    EXPECT_EQ(refused([&](auto&, auto& plane) { plane.per_t = plane.per_s; }), "per_t");
    EXPECT_EQ(refused([&](auto&, auto& plane) { plane.texel.x = nan; }), "texel");
    EXPECT_EQ(refused([&](auto&, auto& plane) { plane.texel.y = 0x1p41; }).substr(0, 6), "corner");
    EXPECT_EQ(refused([&](auto&, auto& plane) { plane.x = max_footprint_origin + 1; }).substr(0, 10),
              "the origin");
}

TEST(FootprintFromRays, GivesAFootprintOrAReasonWhateverComes) {
    int taken = 0;
    for (std::int64_t i = 0; i < 20'000; ++i) {
        std::int64_t n = 0;
        const auto number = [&] {
            const std::uint64_t bits = hash(11, stream("rays"), i, n++);
            const double unit = static_cast<double>(bits >> 11) * 0x1p-52 - 1;
            const int exponent = static_cast<int>(bits % 64) - 32;
            return bits % 7 == 0 ? 0 : std::ldexp(unit, i % 2 == 0 ? exponent : exponent / 8);
        };
        const auto vector = [&] { return WorldVector{number(), number(), number()}; };
        const RayDifferentials rays{vector(), vector(), vector(), vector(), vector(), vector()};
        const TexturedPlane plane{vector(), vector(), vector(), 7, -9, {number(), number()}, 0};
        const auto footprint = footprint_from_rays(rays, plane);
        if (!footprint) {
            EXPECT_FALSE(footprint.error().detail.empty());
            continue;
        }
        ++taken;
        ASSERT_TRUE(check_footprint(*footprint)) << i;
    }
    EXPECT_GT(taken, 5'000);  // half of the planes lie in front
}

}  // namespace
}  // namespace tessera
