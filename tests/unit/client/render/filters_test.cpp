// Each filter's shader, on pages and on the whole texture.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "client/render/situation_renderer.h"
#include "shared/math/image_error.h"
#include "shared/math/srgb.h"
#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/repeated_pages.h"

namespace tessera {
namespace {

using testing::RepeatedPages;

constexpr std::int32_t width = 96, height = 84;

/// Texels = (s, t) / w.
Situation seen(std::array<double, 9> to_texels, std::int64_t origin) {
    return {"made", "Made for a test", width, height, {{to_texels}}, origin, origin};
}

/// A plane without horizon: footprints of 2 to 20 texels across, up to 12 times as long, at all angles.
Situation slanted_plane(std::int64_t origin = 0) {
    return seen({3.1, 0.7, 12.3, -0.4, 1.2, 60.6, 0, 0.02, 0.15}, origin);
}

/// Texels along the axes: pixel (x, y) covers [x·scale_x, (x + 1)·scale_x) × …
Situation upright(double scale_x, double scale_y, double shift_x, double shift_y) {
    return seen({scale_x, 0, shift_x, 0, scale_y, shift_y, 0, 0, 1}, 0);
}

std::vector<FilterChoice> all_filters() {
    std::vector<FilterChoice> choices;
    for (const Filter filter : filters)
        if (filter != Filter::driver_anisotropic) choices.push_back({.filter = filter});
    choices.push_back({.filter = Filter::line_integral, .columns = 3});
    return choices;
}

class Filters : public ::testing::Test {
  protected:
    template <class... Texels>
    FloatPicture draw(const Situation& situation, FilterChoice filter, const Texels&... texels) {
        if (const auto drawn = renderer_.draw(situation, texels..., filter); !drawn)
            throw std::runtime_error{drawn.error().detail};
        FloatPicture picture = renderer_.read();
        EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
        return picture;
    }

    std::unique_ptr<GlContext> context_ = testing::headless_context();
    SituationRenderer renderer_{width, height};
};

WholeTexture whole_of(const Rgba8Image& image) {
    WholeTexture whole{averaged_levels(image)};
    if (const auto there = whole.bring_integrals(); !there) throw std::runtime_error{there.error().detail};
    return whole;
}

double code(float linear) { return fractional_srgb_code(static_cast<double>(linear)); }

TEST_F(Filters, GiveTheSamePictureFromPagesAsFromTheWholeTexture) {
    const Rgba8Image image = testing::noise_image(512);
    const WholeTexture whole = whole_of(image);
    // The origin on a multiple of the image's side: pages repeat it from there
    constexpr std::int64_t origin = 1 << 15;
    const RepeatedPages pages{averaged_levels(image),
                              Extent{8},
                              {origin, origin, 0, 0},
                              {origin - 256, origin - 256, 0, 0},
                              {origin + 2304, origin + 768, 0, 0},
                              9};
    for (const FilterChoice filter : all_filters()) {
        const FloatPicture expected = draw(slanted_plane(), filter, whole);
        const FloatPicture paged = draw(slanted_plane(origin), filter, pages.textures(), Extent{8}, 32);
        double worst = 0, spread = 0;
        for (std::size_t at = 0; at < expected.values.size(); ++at) {
            worst = std::max(worst, std::abs(code(paged.values[at]) - code(expected.values[at])));
            spread = std::max(spread, std::abs(code(expected.values[at]) - code(expected.values[at % 4])));
        }
        std::cout << name_of(filter.filter) << ": at most " << worst << " codes apart\n";
        EXPECT_LE(worst, 1.0) << name_of(filter.filter);
        EXPECT_GT(spread, 40.0) << name_of(filter.filter) << ": there is something to see";
    }
}

TEST_F(Filters, KeepAConstantConstant) {
    for (const std::array<std::uint8_t, 3> codes :
         {std::array<std::uint8_t, 3>{3, 128, 251}, {11, 64, 200}}) {
        const WholeTexture whole = whole_of(testing::constant_image(256, codes));
        for (const FilterChoice filter : all_filters()) {
            const FloatPicture picture = draw(slanted_plane(), filter, whole);
            double worst = 0;
            for (std::size_t at = 0; at < picture.values.size(); ++at)
                if (at % 4 < 3) worst = std::max(worst, std::abs(code(picture.values[at]) - codes[at % 4]));
            // A driver's decoding of sRGB may be off by a part of a code; the integrals' is ours
            EXPECT_LE(worst, filter.filter == Filter::line_integral ? 0.05 : 0.4) << name_of(filter.filter);
        }
    }
}

/// The mean of the texels' squares under an upright rectangle, in doubles, texel by texel.
std::array<double, 3> mean_under(const Rgba8Image& image, double left, double top, double right,
                                 double bottom) {
    std::array<double, 3> sum{};
    for (double y = std::floor(top); y < bottom; ++y)
        for (double x = std::floor(left); x < right; ++x) {
            const double share =
                (std::min(x + 1, right) - std::max(x, left)) * (std::min(y + 1, bottom) - std::max(y, top));
            const std::uint8_t* texel = image.row(static_cast<int>(y) & (image.height - 1)) +
                                        4 * (static_cast<int>(x) & (image.width - 1));
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += share * static_cast<double>(srgb_to_steps[texel[c]]) / 65535;
        }
    for (double& channel : sum) channel /= (right - left) * (bottom - top);
    return sum;
}

TEST_F(Filters, LineIntegralsOfUprightFootprintsEqualTheAreaIntegralInDoubles) {
    const Rgba8Image image = testing::noise_image(1024);
    const WholeTexture whole = whole_of(image);
    // Of a texel and less (bilinear), of a few, long both ways, over pages' borders, through many repeats
    const struct {
        double x, y;
    } sizes[] = {{1, 1}, {1.37, 2.6}, {5.2, 1.1}, {3.9, 211.3}, {160.7, 2.2}, {7.5, 7.5}, {0.6, 0.4}};
    for (const auto [x, y] : sizes) {
        const Situation situation = upright(x, y, 31.7, -22.1);
        const FloatPicture picture = draw(situation, {.filter = Filter::line_integral, .columns = 8}, whole);
        const double grow_x = std::max(x, 1.0) - x, grow_y = std::max(y, 1.0) - y;
        double worst = 0;
        for (std::int32_t py = 0; py < height; py += 3)
            for (std::int32_t px = 0; px < width; px += 3) {
                const auto expected =
                    mean_under(image, px * x + 31.7 - grow_x / 2, py * y - 22.1 - grow_y / 2,
                               (px + 1) * x + 31.7 + grow_x / 2, (py + 1) * y - 22.1 + grow_y / 2);
                for (std::size_t c = 0; c < 3; ++c)
                    worst = std::max(
                        worst, std::abs(code(picture.pixel(px, py)[c]) - fractional_srgb_code(expected[c])));
            }
        std::cout << x << " x " << y << " texels: at most " << worst << " codes off\n";
        EXPECT_LE(worst, 1.0) << x << " x " << y;
    }
}

TEST_F(Filters, LineIntegralsReadFewTexelsAndSayHowMany) {
    const WholeTexture whole = whole_of(testing::noise_image(256));
    const Situation situation = upright(3.0, 40.0, 0.5, 0.5);
    if (const auto drawn = renderer_.draw(situation, whole, {.filter = Filter::line_integral}, true); !drawn)
        FAIL() << drawn.error().detail;
    const FloatPicture picture = renderer_.read();
    const float texels = picture.pixel(40, 40)[3];
    EXPECT_GE(texels, 16);
    EXPECT_LE(texels, 48);
    if (const auto drawn = renderer_.draw(situation, whole, {.filter = Filter::trilinear}, true); !drawn)
        FAIL() << drawn.error().detail;
    EXPECT_EQ(renderer_.read().pixel(40, 40)[3], 8);
}

TEST_F(Filters, ShowTheCoarserPageWhereTheFineOneIsMissing) {
    // Level 0 is noise and never resident; level 1 is: each filter shows level 1, and nothing of the table
    // top
    const Rgba8Image image = testing::noise_image(512);
    const auto levels = averaged_levels(image);
    constexpr std::int64_t origin = 1 << 15;
    PageTable table{Extent{8}, 32};
    PageTableTexture table_texture{Extent{8}, 32};
    PageStore store{4};
    auto integrals = IntegralStore::make(4);
    ASSERT_TRUE(integrals) << integrals.error().detail;
    table.move_to(origin, origin);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const PageKey page{1, 63 + i % 2, 63 + i / 2};
        store.upload(static_cast<Slot>(i), testing::page_of(levels, page));
        table.show(page, {static_cast<Slot>(i), 1, 0});
    }
    table_texture.update(table);
    for (const int slot : {0, 1, 2, 3})
        (*integrals)->upload_from(store.coded_texture(), gutter_texels, slot, slot);
    const TexelTextures textures{.colour = store.texture(),
                                 .coded = store.coded_texture(),
                                 .table = table_texture.texture(),
                                 .integrals = (*integrals)->texture(),
                                 .integral_table = table_texture.texture()};
    // Footprints of 2.4 texels of level 0, upright: their integral over level 1 is known
    const Situation situation = seen({2.4, 0, -100.3, 0, 2.4, -90.7, 0, 0, 1}, origin);
    const FloatPicture picture = draw(situation, {.filter = Filter::line_integral}, textures, Extent{8}, 32);
    double worst = 0;
    for (std::int32_t py = 0; py < height; ++py)
        for (std::int32_t px = 0; px < width; ++px) {
            const double left = (px * 2.4 - 100.3) / 2, top = (py * 2.4 - 90.7) / 2;
            const auto expected = mean_under(levels[1], left, top, left + 1.2, top + 1.2);
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(
                    worst, std::abs(code(picture.pixel(px, py)[c]) - fractional_srgb_code(expected[c])));
        }
    EXPECT_LE(worst, 1.0);
}

}  // namespace
}  // namespace tessera
