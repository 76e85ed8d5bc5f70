// The laws of tests/property/texture on what people see: the painted pebbles and, where they are, real
// photographs.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "server/prepare/prepare.h"
#include "server/scene/image_file.h"
#include "server/scenes/paint_pebbles.h"
#include "server/texture/exchange.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

struct Exemplar {
    std::string name;
    Rgb8Image image;
};

std::vector<Exemplar> exemplars() {
    std::vector<Exemplar> all;
    all.push_back({"pebbles", paint_pebbles(512, 1)});
    for (const char* file : {"rocky-trail.jpg", "leaf-litter.jpg", "gravel-grey.png"}) {
        const std::filesystem::path path = std::filesystem::path{EXEMPLARS} / file;
        if (!std::filesystem::exists(path)) {
            std::cout << path << " is not here; its laws are tested on the pebbles alone\n";
            continue;
        }
        auto image = read_rgb_image(path);
        EXPECT_TRUE(image.has_value()) << image.error().detail;
        if (image) all.push_back({file, *image});
    }
    return all;
}

ExchangeAsset prepared(const Rgb8Image& photo) {
    SilentProgress progress;
    auto asset = prepare_content_exchange(
        photo, {.tile_side = 128, .patches = 24, .contents = 6, .blend_texels = 8, .seed = 3}, nullptr,
        progress);
    EXPECT_TRUE(asset.has_value()) << asset.error().detail;
    return asset->asset;
}

LinearImage linear(const Texture& texture, const TexelRegion& region) {
    LinearImage image;
    EXPECT_TRUE(texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, image).has_value());
    return image;
}

TEST(SampleScenes, APageIsTheReductionOfItsFourChildrenAtEveryLevel) {
    for (const Exemplar& exemplar : exemplars()) {
        const auto texture = make_exchange_texture(prepared(exemplar.image), {.seed = 8});
        for (std::uint8_t level = 1; level <= 20; ++level) {
            SCOPED_TRACE(exemplar.name + " level " + std::to_string(level));
            const PageKey page{level, 0, 0};
            const TexelRegion region = region_of(page);
            const TexelRegion below{static_cast<std::uint8_t>(level - 1), 0, 0, 512, 512};
            const LinearImage parent_page = linear(*texture, region), children = linear(*texture, below);
            Rgba8Image sent, sent_children;
            ASSERT_TRUE(texture->evaluate(region, Budget{}, sent).has_value());
            ASSERT_TRUE(texture->evaluate(below, Budget{}, sent_children).has_value());
            double worst = 0, mean = 0;
            int worst_sent = 0;
            for (std::int32_t y = 0; y < 256; ++y)
                for (std::int32_t x = 0; x < 256; ++x)
                    for (std::int32_t c = 0; c < 3; ++c) {
                        const auto average = [&](const auto& image, auto&& value) {
                            return 0.25 * (value(image.row(2 * y)[8 * x + c]) +
                                           value(image.row(2 * y)[8 * x + 4 + c]) +
                                           value(image.row(2 * y + 1)[8 * x + c]) +
                                           value(image.row(2 * y + 1)[8 * x + 4 + c]));
                        };
                        const double reduced = average(children, [](float v) { return double{v}; });
                        const double error = (parent_page.row(y)[4 * x + c] - reduced) / code_in_linear;
                        worst = std::max(worst, std::abs(error));
                        mean += error / (3 * 256 * 256);
                        const double reduced_sent =
                            average(sent_children, [](std::uint8_t code) { return double{from_srgb(code)}; });
                        const int code = steps_to_srgb()[to_steps(static_cast<float>(reduced_sent))];
                        worst_sent = std::max(worst_sent, std::abs(code - sent.row(y)[4 * x + c]));
                    }
            EXPECT_LT(worst, 0.02);
            EXPECT_LT(std::abs(mean), 0.02);
            EXPECT_LE(worst_sent, 1);  // whole codes: at most 1.1 apart is at most 1 apart
        }
    }
}

TEST(SampleScenes, UnblendedLevel0ShowsOnlyColoursOfTheExemplar) {
    for (const Exemplar& exemplar : exemplars()) {
        const auto texture = make_exchange_texture(prepared(exemplar.image), {.seed = 8, .blended = false});
        std::set<std::tuple<int, int, int>> colours;
        for (std::size_t i = 0; i < exemplar.image.bytes.size(); i += 3)
            colours.emplace(exemplar.image.bytes[i], exemplar.image.bytes[i + 1],
                            exemplar.image.bytes[i + 2]);
        Rgba8Image page;
        ASSERT_TRUE(texture->evaluate({0, -1000, 123456789, 512, 512}, Budget{}, page).has_value());
        for (std::size_t i = 0; i < page.bytes.size(); i += 4)
            ASSERT_TRUE(colours.contains({page.bytes[i], page.bytes[i + 1], page.bytes[i + 2]}))
                << exemplar.name;
    }
}

TEST(SampleScenes, TheFarViewKeepsTheMeanOfTheNearOne) {
    // The authors' own library darkens by up to 18 codes here
    for (const Exemplar& exemplar : exemplars()) {
        const auto texture = make_exchange_texture(prepared(exemplar.image), {.seed = 8});
        const LinearImage far = linear(*texture, {11, 0, 0, 1, 1}),
                          near = linear(*texture, {0, 0, 0, 2048, 2048});
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t i = c; i < near.values.size(); i += 4) sum += double{near.values[i]};
            EXPECT_NEAR(far.values[c], sum / (2048.0 * 2048.0), 0.02 * code_in_linear) << exemplar.name;
        }
    }
}

}  // namespace
}  // namespace tessera
