#include "server/pages/page_encoder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <thread>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <webp/decode.h>
#include <zstd.h>

#include "server/pages/one_colour_pages.h"
#include "server/texture/constant_texture.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// What a reader that nobody here wrote makes of an encoded page: straight RGBA.
Rgba8Image decode(const EncodedBytes& bytes, PageFormat format) {
    if (format == PageFormat::webp) {  // OpenImageIO's reader always premultiplies
        int width = 0, height = 0;
        EXPECT_NE(WebPGetInfo(bytes.data(), bytes.size(), &width, &height), 0);
        Rgba8Image image{width, height};
        EXPECT_NE(
            WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.bytes.data(), image.bytes.size(), width * 4),
            nullptr);
        return image;
    }
    const auto file = std::filesystem::temp_directory_path() /
                      ("tessera_page_" + std::to_string(getpid()) + "." + std::string{extension(format)});
    std::ofstream{file, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                                static_cast<std::streamsize>(bytes.size()));
    OIIO::ImageSpec config;
    config["oiio:UnassociatedAlpha"] = 1;
    const auto input = OIIO::ImageInput::open(file.string(), &config);
    std::filesystem::remove(file);
    if (!input) {
        ADD_FAILURE() << OIIO::geterror();
        return {};
    }
    const OIIO::ImageSpec& spec = input->spec();
    Rgba8Image image{spec.width, spec.height};
    for (std::size_t i = 3; i < image.bytes.size(); i += 4) image.bytes[i] = 255;
    EXPECT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, image.bytes.data(), 4))
        << input->geterror();
    return image;
}

/// Waves and noise, with alpha from `alpha(x, y)`.
template <class Alpha>
Rgba8Image make_image(std::int32_t side, Alpha alpha) {
    Rgba8Image image{side, side};
    std::uint32_t state = 1;
    for (std::int32_t y = 0; y < side; ++y) {
        for (std::int32_t x = 0; x < side; ++x) {
            state = state * 1664525 + 1013904223;
            std::uint8_t* texel = image.row(y) + 4 * x;
            const std::uint32_t a = alpha(x, y);
            for (int channel = 0; channel < 3; ++channel) {
                const std::uint32_t wave = static_cast<std::uint32_t>((x * (channel + 1) + y * 2) & 127);
                const std::uint32_t code = wave + (state >> (8 + channel * 5) & 31);
                const std::uint32_t steps = srgb_to_steps[code] * a / 255;
                texel[channel] = steps_to_srgb()[steps];
            }
            texel[3] = static_cast<std::uint8_t>(a);
        }
    }
    return image;
}

const auto opaque = [](std::int32_t, std::int32_t) { return 255u; };
const auto fading = [](std::int32_t x, std::int32_t y) {
    return static_cast<std::uint32_t>((x * 3 + y) & 255);
};

TEST(PageEncoder, LosslessFormatsGiveBackEveryTexelOfAnOpaquePage) {
    for (const std::int32_t side : {1, 7, 256, 288}) {
        const Rgba8Image image = make_image(side, opaque);
        for (const PageFormat format : {PageFormat::png, PageFormat::webp})
            EXPECT_EQ(decode(encode_page(image, format).value(), format), image) << extension(format) << side;
        EXPECT_EQ(encode_page(image, PageFormat::rgba).value(), image.bytes);
    }
}

TEST(PageEncoder, LosslessFormatsCarryStraightAlpha) {
    const Rgba8Image image = make_image(256, fading);
    const Rgba8Image straight = to_straight_alpha(image);
    for (const PageFormat format : {PageFormat::png, PageFormat::webp})
        EXPECT_EQ(decode(encode_page(image, format).value(), format), straight) << extension(format);
}

TEST(PageEncoder, DividesAlphaOutInLinearLight) {
    Rgba8Image image{1, 1};
    const auto linear = to_linear({200, 100, 50, 128});
    LinearImage source{1, 1};
    std::copy(linear.begin(), linear.end(), source.values.begin());
    encode(source, image);
    const Rgba8Image straight = to_straight_alpha(image);
    EXPECT_NEAR(straight.bytes[0], 200, 1);
    EXPECT_NEAR(straight.bytes[1], 100, 1);
    EXPECT_NEAR(straight.bytes[2], 50, 1);
    EXPECT_EQ(straight.bytes[3], 128);
}

TEST(PageEncoder, JpegIsThePageOverBlackWithinItsQuality) {
    const Rgba8Image image = make_image(256, fading);
    const Rgba8Image decoded = decode(encode_page(image, PageFormat::jpg).value(), PageFormat::jpg);
    double squares = 0;
    for (std::size_t i = 0; i < image.bytes.size(); ++i)
        if (i % 4 != 3) squares += std::pow(double(image.bytes[i]) - double(decoded.bytes[i]), 2);
    EXPECT_LT(std::sqrt(squares / (256.0 * 256 * 3)), 8.0);
}

TEST(PageEncoder, APageOfOneColourIsAFewBytesInEveryLosslessFormat) {
    for (const std::uint8_t alpha : std::initializer_list<std::uint8_t>{255, 128, 0}) {
        Rgba8Image image{264, 264};
        const std::uint8_t code = alpha == 0 ? std::uint8_t{0} : std::uint8_t{77};
        for (std::size_t i = 0; i < image.bytes.size(); ++i) image.bytes[i] = i % 4 == 3 ? alpha : code;
        ASSERT_TRUE(is_one_colour(image));
        for (const PageFormat format : {PageFormat::png, PageFormat::webp}) {
            const EncodedBytes bytes = encode_page(image, format).value();
            EXPECT_LT(bytes.size(), 200u) << extension(format);
            EXPECT_EQ(decode(bytes, format), to_straight_alpha(image)) << extension(format) << int(alpha);
        }
        image.bytes.back() ^= 1;
        EXPECT_FALSE(is_one_colour(image));
    }
}

TEST(PageEncoder, APngSaysThatColourIsSrgbAndNothingOfData) {
    const auto says_srgb = [](const EncodedBytes& png) {
        constexpr std::string_view chunk = "sRGB";
        return std::search(png.begin(), png.end(), chunk.begin(), chunk.end()) != png.end();
    };
    Rgba8Image one_colour{256, 256};
    std::fill(one_colour.bytes.begin(), one_colour.bytes.end(), std::uint8_t{255});
    for (const Rgba8Image& image : {make_image(64, opaque), one_colour}) {
        EXPECT_TRUE(says_srgb(encode_page(image, PageFormat::png).value()));
        const EncodedBytes data = encode_page(image, PageFormat::png, TexelKind::data).value();
        EXPECT_FALSE(says_srgb(data));
        EXPECT_EQ(decode(data, PageFormat::png), image);
    }
}

TEST(OneColourPages, TellColourFromData) {
    Rgba8Image image{256, 256};
    std::fill(image.bytes.begin(), image.bytes.end(), std::uint8_t{255});
    OneColourPages pages;
    const auto color =
                   pages.encode(image, TexelKind::color, PageFormat::png, ContentCoding::identity).value(),
               data = pages.encode(image, TexelKind::data, PageFormat::png, ContentCoding::identity).value();
    EXPECT_NE(*color, *data);
    EXPECT_EQ(pages.encode(image, TexelKind::color, PageFormat::png, ContentCoding::identity).value(), color);
}

TEST(PageEncoder, TheSameTexelsGiveTheSameBytesOnEveryThread) {
    const Rgba8Image image = make_image(256, fading);
    for (const PageFormat format : page_formats) {
        const EncodedBytes here = encode_page(image, format).value();
        EncodedBytes there;
        std::thread{[&] { there = encode_page(image, format).value(); }}.join();
        EXPECT_EQ(encode_page(image, format).value(), here) << extension(format);
        EXPECT_EQ(there, here) << extension(format);
    }
}

TEST(PageEncoder, ZstdFramesGiveBackTheirBytes) {
    const Rgba8Image image = make_image(256, opaque);
    const EncodedBytes frame = compress_zstd(image.bytes).value();
    EncodedBytes back(image.bytes.size());
    ASSERT_EQ(ZSTD_decompress(back.data(), back.size(), frame.data(), frame.size()), back.size());
    EXPECT_EQ(back, image.bytes);
    EXPECT_EQ(ZSTD_getFrameContentSize(frame.data(), frame.size()), image.bytes.size());
}

}  // namespace
}  // namespace tessera
