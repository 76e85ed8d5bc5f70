// The same views by a ray-caster of our own on the CPU, in doubles, from the texels themselves: it knows no
// pages, no gutters and no page table, so a seam, a wrong level, a filter in the wrong light or a shifted
// texel all show.
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "shared/math/srgb.h"
#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

using testing::Code4;
using testing::Offscreen;
using Rgb = std::array<double, 3>;

struct Difference {
    double psnr = 0;
    double worst = 0;  ///< In codes
    std::size_t pixels = 0;
};

class RayCaster {
  public:
    RayCaster(const Camera& camera, int width, int height, Extent extent)
        : camera_{camera}, width_{width}, height_{height}, extent_{extent} {}

    /// Where the ray of a point of the picture meets the plane: the camera's angles applied one after the
    /// other.
    std::array<double, 2> ground(double px, double py) const {
        const double degree = std::numbers::pi / 180,
                     tangent = std::tan(camera_.field_of_view_degrees / 2 * degree);
        const double x = (px - width_ / 2.0) / (height_ / 2.0) * tangent,
                     y = (height_ / 2.0 - py) / (height_ / 2.0) * tangent;
        const double pitch = camera_.pitch_degrees * degree, yaw = camera_.yaw_degrees * degree;
        const double north = std::cos(pitch) - y * std::sin(pitch),
                     rise = std::sin(pitch) + y * std::cos(pitch);
        const double reach = camera_.height_texels / -rise;
        if (rise >= 0) return {NAN, NAN};
        return {reach * (x * std::cos(yaw) + north * std::sin(yaw)),
                reach * (x * std::sin(yaw) - north * std::cos(yaw))};
    }

    /// sRGB codes, unrounded; NaN above the horizon.
    Rgb pixel(int px, int py) const {
        const double x = px + 0.5, y = py + 0.5, e = 1e-3;
        const auto at = ground(x, y);
        const auto left = ground(x - e, y), right = ground(x + e, y), above = ground(x, y - e),
                   below = ground(x, y + e);
        if (std::isnan(at[0]) || std::isnan(above[0])) return {NAN, NAN, NAN};
        const double along_row = std::hypot(right[0] - left[0], right[1] - left[1]) / (2 * e);
        const double along_column = std::hypot(below[0] - above[0], below[1] - above[1]) / (2 * e);
        const double level =
            std::clamp(std::log2(std::max(along_row, along_column)), 0.0, static_cast<double>(extent_.n));
        const int finer = static_cast<int>(level);
        const Rgb a = bilinear(finer, at), b = bilinear(std::min<int>(finer + 1, extent_.n), at);
        Rgb codes;
        for (std::size_t c = 0; c < 3; ++c) codes[c] = encode(a[c] + (level - finer) * (b[c] - a[c]));
        return codes;
    }

  private:
    Rgb bilinear(int level, const std::array<double, 2>& ground) const {
        const PlanePoint eye = camera_.ground;
        const std::int64_t side = std::int64_t{1} << level;
        const auto split = [&](std::int64_t whole, double fraction, double offset) {
            const double within =
                (static_cast<double>(whole & (side - 1)) + fraction + offset) / static_cast<double>(side) -
                0.5;
            return std::pair{(whole >> level) + static_cast<std::int64_t>(std::floor(within)),
                             within - std::floor(within)};
        };
        const auto [column, u] = split(eye.x, eye.fraction_x, ground[0]);
        const auto [row, v] = split(eye.y, eye.fraction_y, ground[1]);
        Rgb sum{};
        for (int i = 0; i < 4; ++i) {
            const Code4 texel = testing::noise_texel(level, column + i % 2, row + i / 2);
            const double weight = (i % 2 ? u : 1 - u) * (i / 2 ? v : 1 - v);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(from_srgb(texel[c]));
        }
        return sum;
    }
    static double encode(double linear) {
        return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
    }

    Camera camera_;
    int width_, height_;
    Extent extent_;
};

Difference compare(const Rgba8Image& image, const RayCaster& caster) {
    Difference difference;
    double squares = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Rgb expected = caster.pixel(x, y);
            if (std::isnan(expected[0])) continue;
            ++difference.pixels;
            for (std::size_t c = 0; c < 3; ++c) {
                const double d = std::abs(expected[c] - image.row(y)[4 * static_cast<std::size_t>(x) + c]);
                squares += d * d;
                difference.worst = std::max(difference.worst, d);
            }
        }
    }
    difference.psnr = 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(difference.pixels) / squares);
    return difference;
}

TEST(RayCast, OfTheSameViewOnTheCpuEqualsTheFrame) {
    const auto paint = [](PageKey page) { return testing::paint_page(page, testing::noise_texel); };
    constexpr std::int64_t far = std::int64_t{1} << 37;
    const Camera cameras[] = {
        {.ground = {far, far, 0.5, 0.25}, .height_texels = 180, .yaw_degrees = 0, .pitch_degrees = -90},
        {.ground = {far + 255, far - 3, 0.9, 0.1},
         .height_texels = 700,
         .yaw_degrees = 123,
         .pitch_degrees = -50},
        {.ground = {far / 2 + 77, far + 99, 0, 0},
         .height_texels = 900,
         .yaw_degrees = -31,
         .pitch_degrees = -24},
        {.ground = {far, far / 4, 0, 0}, .height_texels = 5000, .yaw_degrees = 45, .pitch_degrees = -6},
    };
    for (const Camera& camera : cameras) {
        Offscreen offscreen{Extent{30}, paint, 400, 350, {.slots = 128}};
        offscreen.settle(camera);
        const Rgba8Image image = offscreen.draw(camera, {.haze = false});
        const Difference difference = compare(image, RayCaster{camera, 400, 350, Extent{30}});
        std::cout << "pitch " << camera.pitch_degrees << ": PSNR " << difference.psnr << " dB, worst "
                  << difference.worst << " codes over " << difference.pixels << " pixels\n";
        EXPECT_GT(difference.pixels, 70'000u);
        EXPECT_GT(difference.psnr, 40);
        EXPECT_LT(difference.worst, 6) << "a seam or a wrong texel";
    }
}

}  // namespace
}  // namespace tessera
