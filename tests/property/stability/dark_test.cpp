// Dark colours: where a step of linear light is a large part of a code, nothing may be lost on the way up.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/filter/texel_pages.h"
#include "server/scene/image_file.h"
#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"
#include "server/texture/kernels.h"
#include "shared/math/srgb.h"
#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

constexpr std::uint8_t top = 20;
using Mean = std::array<double, 3>;

/// The sRGB code of a linear value, with what lies between two codes as their fraction.
double real_code(double linear) {
    std::uint8_t code = 0;
    while (code < 254 && double{from_srgb(static_cast<std::uint8_t>(code + 1))} <= linear) ++code;
    const double from = double{from_srgb(code)}, to = double{from_srgb(static_cast<std::uint8_t>(code + 1))};
    return code + (linear - from) / (to - from);
}

/// The furthest channel, in codes.
double apart(const Mean& a, const Mean& b) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(real_code(a[c]) - real_code(b[c])));
    return worst;
}

Mean mean_of(const LinearImage& image) {
    Mean sum{};
    for (std::size_t i = 0; i < image.values.size(); ++i)
        if (i % 4 < 3) sum[i % 4] += double{image.values[i]} * 4 / static_cast<double>(image.values.size());
    return sum;
}
Mean mean_of(const Rgba8Image& image) {
    Mean sum{};
    for (std::size_t i = 0; i < image.bytes.size(); ++i)
        if (i % 4 < 3)
            sum[i % 4] += double{from_srgb(image.bytes[i])} * 4 / static_cast<double>(image.bytes.size());
    return sum;
}

Rgb8Image darkened(Rgb8Image image) {
    for (std::uint8_t& code : image.bytes) code = static_cast<std::uint8_t>(code / 16);
    return image;
}
Rgb8Image crop(const Rgb8Image& image, std::int32_t side) {
    Rgb8Image part{side, side, {}};
    for (std::int32_t y = 0; y < side; ++y) {
        const auto row = image.bytes.begin() + std::ptrdiff_t{3} * y * image.width;
        part.bytes.insert(part.bytes.end(), row, row + std::ptrdiff_t{3} * side);
    }
    return part;
}

/// Under-exposed by four stops of codes: the noise of synthetic_asset.h, and a real photograph where there is
/// one.
struct Photograph {
    std::string name;
    Rgb8Image exemplar;  ///< 128 texels a side, or more.
};
std::vector<Photograph> dark_photographs() {
    std::vector<Photograph> all{{"made", darkened(tests::make_synthetic_asset({}).exemplar)}};
    const std::filesystem::path file = std::filesystem::path{EXEMPLARS} / "leaf-litter.jpg";
    if (!std::filesystem::exists(file)) {
        std::cout << "NOT TRIED: " << file.filename()
                  << " is not beside the checkout; the made photograph is\n";
        return all;
    }
    const auto image = read_rgb_image(file);
    EXPECT_TRUE(image.has_value()) << image.error().detail;
    if (image) all.push_back({"leaf-litter", darkened(crop(*image, 512))});
    return all;
}

TEST(Dark, EveryCodeSurvivesFromAPageToTheNextAtEveryLevelAndOnEveryKernel) {
    for (int c = 0; c < 256; ++c) {
        const auto code = static_cast<std::uint8_t>(c);
        const auto texture = make_constant_texture({code, code, code, 255});
        for (const std::uint8_t level : std::array<std::uint8_t, 3>{0, 10, max_level}) {
            LinearImage linear;
            Rgba8Image sent;
            ASSERT_TRUE(texture->evaluate({level, -2, 5, 4, 1}, {}, linear));
            encode(linear, sent);
            ASSERT_EQ(sent.bytes[0], code);
            ASSERT_TRUE(texture->evaluate({level, -2, 5, 4, 1}, {}, sent));
            ASSERT_EQ(sent.bytes[0], code);
        }
        const std::vector<float> row(std::size_t{3} * 19, from_srgb(code));
        for (std::size_t k = 0; k < available_kernels().count; ++k) {
            std::vector<std::uint8_t> codes(std::size_t{4} * 19);
            available_kernels().items[k]->encode(row.data(), 19, codes.data());
            for (std::size_t i = 0; i < codes.size(); ++i)
                ASSERT_EQ(codes[i], i % 4 == 3 ? 255 : code) << available_kernels().items[k]->name;
        }
    }
    std::cout << "256 codes of 256, with " << available_kernels().count << " sets of kernels\n";
}

TEST(Dark, AStoredPhotographKeepsItsMeanThrough20Levels) {
    for (const Photograph& photo : dark_photographs()) {
        const Rgb8Image image = crop(photo.exemplar, 128);
        LinearImage linear{128, 128};
        for (std::size_t i = 0; i < linear.values.size(); ++i)
            linear.values[i] = i % 4 == 3 ? 1.0F : from_srgb(image.bytes[i / 4 * 3 + i % 4]);
        const Mean truth = mean_of(linear);
        const auto pages = pages_of_image(linear, Beyond::repeat);
        double worst_linear = 0, worst_sent = 0;
        for (std::uint8_t level = 0; level <= top; ++level) {
            const auto page = pages->page(level, -1, 3, 0, {});
            ASSERT_TRUE(page);
            LinearImage texels{256, 256};
            for (std::size_t i = 0; i < texels.values.size(); ++i)
                texels.values[i] = static_cast<float>((*page)->steps[i]) / linear_one;
            Rgba8Image sent;
            encode(texels, sent);
            worst_linear = std::max(worst_linear, apart(mean_of(texels), truth));
            worst_sent = std::max(worst_sent, apart(mean_of(sent), truth));
        }
        std::cout << photo.name << " (mean code " << real_code(truth[1]) << ") stored: mean within "
                  << worst_linear << " code linear, " << worst_sent << " in 8 bits\n";
        EXPECT_LT(worst_linear, 0.05);
        EXPECT_LE(worst_sent, 0.5);
    }
}

TEST(Dark, EveryByExampleTextureKeepsItsMeanThrough20Levels) {
    using O = ExchangeOptions;
    struct Case {
        const char* name;
        ExchangeAsset asset;
        ExchangeOptions options;
    };
    for (const Photograph& photo : dark_photographs()) {
        std::vector<Case> cases{
            {"content exchange", tests::make_synthetic_asset({}), O{.seed = 3, .types = 256}},
            {"unblended", tests::make_synthetic_asset({}), O{.seed = 3, .types = 256, .blended = false}},
            {"interchange", tests::make_synthetic_interchange({.patches = 100}), O{.types = 64}},
            {"wang", tests::make_synthetic_wang({.tile_side = 32}), O{.types = 64}}};
        for (Case& one : cases) {
            one.asset.exemplar = crop(photo.exemplar, 128);
            one.asset.tile = crop(photo.exemplar, one.asset.tile_side);
            const auto texture = make_exchange_texture(one.asset, one.options);
            // The sum of what each level's mean differs by from the level's below, on the same ground
            Mean first{}, drifted{};
            double worst_linear = 0, worst_sent = 0;
            for (std::uint8_t level = 0; level <= top; ++level) {
                LinearImage page, children;
                Rgba8Image sent;
                const TexelRegion region{level, -40, 24, 64, 64};
                ASSERT_TRUE(texture->evaluate(region, {.accuracy = Accuracy::exact}, page));
                ASSERT_TRUE(texture->evaluate(region, {.accuracy = Accuracy::exact}, sent));
                const Mean here = mean_of(page);
                worst_sent = std::max(worst_sent, apart(mean_of(sent), here));
                if (level == 0) {
                    first = drifted = here;
                    continue;
                }
                ASSERT_TRUE(texture->evaluate({static_cast<std::uint8_t>(level - 1), -80, 48, 128, 128},
                                              {.accuracy = Accuracy::exact}, children));
                const Mean under = mean_of(children);
                for (std::size_t c = 0; c < 3; ++c) drifted[c] += here[c] - under[c];
                worst_linear = std::max(worst_linear, apart(drifted, first));
            }
            std::cout << photo.name << " (mean code " << real_code(first[1]) << "), " << one.name
                      << ": mean within " << worst_linear << " code linear, " << worst_sent << " in 8 bits\n";
            EXPECT_LT(worst_linear, 0.05) << one.name;
            EXPECT_LE(worst_sent, 0.5) << one.name;
        }
    }
}

}  // namespace
}  // namespace tessera
