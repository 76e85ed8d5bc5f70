#include "server/scene/image_file.h"

#include <fstream>
#include <functional>
#include <memory>

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <webp/encode.h>

#include "server/scene/png_file.h"
#include "shared/math/hash.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Rgb8Image noise(std::int32_t width, std::int32_t height) {
    Rgb8Image image{width, height, {}};
    for (std::int32_t i = 0; i < 3 * width * height; ++i)
        image.bytes.push_back(static_cast<std::uint8_t>(hash(1, 2, i, 0)));
    return image;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream in{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

void write_bytes(const fs::path& file, const std::string& bytes) {
    std::ofstream{file, std::ios::binary} << bytes;
}

/// Writes through OIIO, as other programs do.
void write_foreign(const fs::path& file, int width, int height, int channels, OIIO::TypeDesc type,
                   const void* samples, const std::function<void(OIIO::ImageSpec&)>& change = {}) {
    OIIO::ImageSpec spec{width, height, channels, type};
    if (channels == 2) spec.alpha_channel = 1;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (change) change(spec);
    auto out = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(out) << OIIO::geterror();
    ASSERT_TRUE(out->open(file.string(), spec)) << out->geterror();
    ASSERT_TRUE(out->write_image(type, samples)) << out->geterror();
    ASSERT_TRUE(out->close());
}

class ImageFile : public testing::Test {
  protected:
    tests::TemporaryFolder folder;
    fs::path at(const char* name) const { return folder.path / name; }

    void expect_refused(const fs::path& file, ErrorCode code, const char* says,
                        const ImageLimits& limits = {}) {
        const auto image = read_rgb_image(file, limits);
        ASSERT_FALSE(image) << file;
        EXPECT_EQ(image.error().code, code) << image.error().detail;
        EXPECT_THAT(image.error().detail, HasSubstr(file.string()));
        EXPECT_THAT(image.error().detail, HasSubstr(says));
        EXPECT_THAT(image.error().detail, testing::Not(HasSubstr("\n")));
    }
};

TEST_F(ImageFile, a_png_of_ours_comes_back_texel_by_texel) {
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 200}, {67, 65}, {256, 1}}) {
        const Rgb8Image image = noise(width, height);
        ASSERT_TRUE(write_rgb_png(at("image.png"), image));
        const auto read = read_rgb_image(at("image.png"));
        ASSERT_TRUE(read) << read.error().detail;
        EXPECT_EQ(read->width, width);
        EXPECT_EQ(read->height, height);
        EXPECT_EQ(read->bytes, image.bytes);
    }
}

TEST_F(ImageFile, the_same_texels_are_the_same_bytes_of_png) {
    ASSERT_TRUE(write_rgb_png(at("one.png"), noise(40, 30)));
    ASSERT_TRUE(write_rgb_png(at("two.png"), noise(40, 30)));
    EXPECT_EQ(bytes_of(at("one.png")), bytes_of(at("two.png")));
    for (const char* chunk : {"tIME", "tEXt", "iTXt"})
        EXPECT_THAT(bytes_of(at("one.png")), testing::Not(HasSubstr(chunk)));
}

TEST_F(ImageFile, labels_come_back_in_8_and_in_16_bits) {
    for (const int largest : {200, 4000}) {
        LabelImage image{50, 41, {}};
        for (int i = 0; i < 50 * 41; ++i)
            image.labels.push_back(static_cast<std::uint16_t>(hash(3, 4, i, 0) % std::uint64_t(largest)));
        ASSERT_TRUE(write_label_png(at("labels.png"), image));
        const auto read = read_label_image(at("labels.png"));
        ASSERT_TRUE(read) << read.error().detail;
        EXPECT_EQ(read->labels, image.labels);
        EXPECT_EQ(bytes_of(at("labels.png"))[24], largest > 255 ? 16 : 8);
    }
}

TEST_F(ImageFile, bits_come_back_one_by_one) {
    for (const auto& [width, height] : {std::pair{1, 1}, {8, 3}, {67, 65}, {200, 1}}) {
        BitMask mask{width, height};
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (hash(5, 6, x, y) % 3 == 0) mask.set(x, y);
        ASSERT_TRUE(write_bit_png(at("bits.png"), mask));
        EXPECT_EQ(bytes_of(at("bits.png"))[24], 1);
        const auto read = read_bit_image(at("bits.png"));
        ASSERT_TRUE(read) << read.error().detail;
        EXPECT_EQ(*read, mask) << width;
    }
    // As other programs save them
    const std::vector<std::uint8_t> greys{0, 100, 127, 128, 255};
    write_foreign(at("grey.png"), 5, 1, 1, OIIO::TypeDesc::UINT8, greys.data());
    const auto read = read_bit_image(at("grey.png"));
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->bytes, std::vector<std::uint8_t>{0b00011000});
    ASSERT_TRUE(write_rgb_png(at("rgb.png"), noise(4, 4)));
    EXPECT_THAT(read_bit_image(at("rgb.png")).error().detail,
                HasSubstr(at("rgb.png").string() + ": is no grey PNG of 1 or 8 bits"));
}

TEST_F(ImageFile, the_first_bytes_tell_the_format_whatever_the_name) {
    const Rgb8Image image = noise(64, 48);
    const std::vector<std::uint8_t> smooth(3 * 64 * 48, 90);
    for (const char* name : {"a.png", "a.tif", "a.webp", "a.jpg"}) {
        const bool lossless = std::string_view{name} != "a.jpg" && std::string_view{name} != "a.webp";
        write_foreign(at(name), 64, 48, 3, OIIO::TypeDesc::UINT8,
                      lossless ? image.bytes.data() : smooth.data());
        fs::rename(at(name), at("misnamed.txt"));
        const auto read = read_rgb_image(at("misnamed.txt"));
        ASSERT_TRUE(read) << name << ": " << read.error().detail;
        EXPECT_EQ(read->width, 64);
        EXPECT_EQ(read->height, 48);
        if (lossless)
            EXPECT_EQ(read->bytes, image.bytes) << name;
        else
            for (const std::uint8_t byte : read->bytes) ASSERT_NEAR(byte, 90, 2) << name;
    }
}

TEST_F(ImageFile, a_tiled_tiff_is_read_like_any_other) {
    const Rgb8Image image = noise(100, 70);
    OIIO::ImageSpec spec{100, 70, 3, OIIO::TypeDesc::UINT8};
    spec.tile_width = spec.tile_height = 32;
    auto out = OIIO::ImageOutput::create(at("tiled.tif").string());
    ASSERT_TRUE(out && out->open(at("tiled.tif").string(), spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, image.bytes.data()) && out->close());
    const auto read = read_rgb_image(at("tiled.tif"));
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->bytes, image.bytes);
}

TEST_F(ImageFile, grey_becomes_rgb_and_16_bits_are_rounded) {
    const std::vector<std::uint16_t> grey{0, 128, 129, 257, 385, 386, 65535, 65407};
    write_foreign(at("grey.png"), 8, 1, 1, OIIO::TypeDesc::UINT16, grey.data());
    const auto read = read_rgb_image(at("grey.png"));
    ASSERT_TRUE(read) << read.error().detail;
    const std::vector<std::uint8_t> expected{0, 0, 1, 1, 1, 2, 255, 255};
    for (std::size_t i = 0; i < expected.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(read->bytes[3 * i + c], expected[i]) << i;
}

TEST_F(ImageFile, opaque_alpha_is_dropped_and_transparency_refused) {
    std::vector<std::uint8_t> rgba{10, 20, 30, 255, 40, 50, 60, 255};
    write_foreign(at("opaque.png"), 2, 1, 4, OIIO::TypeDesc::UINT8, rgba.data());
    const auto read = read_rgb_image(at("opaque.png"));
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_THAT(read->bytes, testing::ElementsAre(10, 20, 30, 40, 50, 60));
    rgba.back() = 254;
    write_foreign(at("clear.png"), 2, 1, 4, OIIO::TypeDesc::UINT8, rgba.data());
    expect_refused(at("clear.png"), ErrorCode::invalid_input, "transparent texels; fill them");
    const std::vector<std::uint8_t> grey_alpha{10, 255, 20, 3};
    write_foreign(at("clear-grey.png"), 2, 1, 2, OIIO::TypeDesc::UINT8, grey_alpha.data());
    expect_refused(at("clear-grey.png"), ErrorCode::invalid_input, "transparent texels; fill them");
}

TEST_F(ImageFile, a_pattern_keeps_its_alpha_in_every_format_that_has_one) {
    const std::vector<std::uint8_t> rgba{10, 20, 30, 255, 40, 50, 60, 128, 200, 100, 0, 7, 9, 8, 7, 254};
    write_foreign(at("a.png"), 2, 2, 4, OIIO::TypeDesc::UINT8, rgba.data());
    write_foreign(at("a.tif"), 2, 2, 4, OIIO::TypeDesc::UINT8, rgba.data());
    std::uint8_t* webp = nullptr;  // OIIO would write it with a loss
    const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), 2, 2, 8, &webp);
    write_bytes(at("a.webp"), {reinterpret_cast<const char*>(webp), size});
    WebPFree(webp);
    for (const char* name : {"a.png", "a.tif", "a.webp"}) {
        const auto read = read_rgba_image(at(name));
        ASSERT_TRUE(read) << name << ": " << read.error().detail;
        EXPECT_EQ(read->bytes, rgba) << name;
    }
    const StraightRgba8Image ours{2, 2, rgba};
    ASSERT_TRUE(write_rgba_png(at("ours.png"), ours));
    EXPECT_EQ(read_rgba_image(at("ours.png"))->bytes, rgba);

    const std::vector<std::uint16_t> wide{257 * 10, 257 * 20, 257 * 30, 65535,
                                          257 * 40, 257 * 50, 257 * 60, 257 * 99};
    write_foreign(at("wide.png"), 2, 1, 4, OIIO::TypeDesc::UINT16, wide.data());
    EXPECT_THAT(read_rgba_image(at("wide.png"))->bytes,
                testing::ElementsAre(10, 20, 30, 255, 40, 50, 60, 99));
    const std::vector<std::uint8_t> grey_alpha{10, 255, 20, 3};
    write_foreign(at("grey.png"), 2, 1, 2, OIIO::TypeDesc::UINT8, grey_alpha.data());
    EXPECT_THAT(read_rgba_image(at("grey.png"))->bytes, testing::ElementsAre(10, 10, 10, 255, 20, 20, 20, 3));
    ASSERT_TRUE(write_rgb_png(at("opaque.png"), noise(1, 1)));
    EXPECT_EQ(read_rgba_image(at("opaque.png"))->bytes[3], 255);
}

TEST_F(ImageFile, premultiplied_texels_are_divided_by_their_alpha) {
    const std::vector<std::uint8_t> premultiplied{100, 50, 0, 128, 0, 0, 0, 0, 10, 20, 30, 255};
    write_foreign(at("a.tif"), 3, 1, 4, OIIO::TypeDesc::UINT8, premultiplied.data(),
                  [](OIIO::ImageSpec& spec) { spec.erase_attribute("oiio:UnassociatedAlpha"); });
    const auto read = read_rgba_image(at("a.tif"));
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_THAT(read->bytes, testing::ElementsAre(199, 100, 0, 128, 0, 0, 0, 0, 10, 20, 30, 255));
}

TEST_F(ImageFile, a_printers_colours_are_refused) {
    const std::vector<std::uint8_t> cmyk(4 * 16 * 16, 40);
    write_foreign(at("cmyk.tif"), 16, 16, 4, OIIO::TypeDesc::UINT8, cmyk.data(), [](OIIO::ImageSpec& spec) {
        spec.attribute("tiff:ColorSpace", "CMYK");
        spec.channelnames = {"C", "M", "Y", "K"};
        spec.alpha_channel = -1;
    });
    // OIIO writes no such JPEG; layout programs do
    const std::unique_ptr<void, int (*)(void*)> compressor{tjInitCompress(), tjDestroy};
    unsigned char* jpeg = nullptr;
    unsigned long bytes = 0;
    ASSERT_EQ(
        tjCompress2(compressor.get(), cmyk.data(), 16, 0, 16, TJPF_CMYK, &jpeg, &bytes, TJSAMP_444, 90, 0),
        0);
    write_bytes(at("cmyk.jpg"), {reinterpret_cast<const char*>(jpeg), bytes});
    tjFree(jpeg);
    for (const char* name : {"cmyk.tif", "cmyk.jpg"})
        expect_refused(at(name), ErrorCode::invalid_input, "the colours of a printer; save it as RGB");
}

TEST_F(ImageFile, stands_as_its_orientation_says) {
    // Texels 0 1 2 / 3 4 5 as stored; what each orientation shows (TIFF 6.0, tag 274)
    const std::vector<std::uint8_t> stored{0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5};
    const std::vector<std::pair<int, std::vector<int>>> shown{
        {1, {3, 0, 1, 2, 3, 4, 5}}, {2, {3, 2, 1, 0, 5, 4, 3}}, {3, {3, 5, 4, 3, 2, 1, 0}},
        {4, {3, 3, 4, 5, 0, 1, 2}}, {5, {2, 0, 3, 1, 4, 2, 5}}, {6, {2, 3, 0, 4, 1, 5, 2}},
        {7, {2, 5, 2, 4, 1, 3, 0}}, {8, {2, 2, 5, 1, 4, 0, 3}}};
    for (const auto& [orientation, expected] : shown) {
        const int value = orientation;
        write_foreign(at("turned.tif"), 3, 2, 3, OIIO::TypeDesc::UINT8, stored.data(),
                      [value](OIIO::ImageSpec& spec) { spec.attribute("Orientation", value); });
        const auto read = read_rgb_image(at("turned.tif"));
        ASSERT_TRUE(read) << read.error().detail;
        EXPECT_EQ(read->width, expected.front()) << orientation;
        for (std::size_t i = 0; i < 6; ++i)
            EXPECT_EQ(read->bytes[3 * i], expected[i + 1]) << orientation << ", " << i;
    }
}

TEST_F(ImageFile, what_is_missing_or_no_image_is_named) {
    expect_refused(at("none.png"), ErrorCode::io_failure, "there is no such file");
    expect_refused(folder.path, ErrorCode::io_failure, "is not a file");
    write_bytes(at("text.png"), "Dear diary, this is not a picture at all.\n");
    expect_refused(at("text.png"), ErrorCode::invalid_input, "no PNG, JPEG, WebP or TIFF");
    write_bytes(at("empty.png"), "");
    expect_refused(at("empty.png"), ErrorCode::invalid_input, "no PNG, JPEG, WebP or TIFF");
    write_bytes(at("picture.gif"), "GIF89a\1\0\1\0");
    expect_refused(at("picture.gif"), ErrorCode::invalid_input, "no PNG, JPEG, WebP or TIFF");
}

TEST_F(ImageFile, a_truncated_image_is_refused_wherever_it_ends) {
    const Rgb8Image image = noise(120, 90);
    for (const char* name : {"a.png", "a.jpg", "a.webp", "a.tif"}) {
        write_foreign(at(name), 120, 90, 3, OIIO::TypeDesc::UINT8, image.bytes.data());
        const std::string whole = bytes_of(at(name));
        for (const std::size_t percent : {3u, 30u, 60u, 90u}) {
            write_bytes(at(name), whole.substr(0, whole.size() * percent / 100));
            SCOPED_TRACE(name + std::string{" cut at "} + std::to_string(percent) + " %");
            expect_refused(at(name), ErrorCode::invalid_input, "truncated");
            EXPECT_THAT(read_rgba_image(at(name)).error().detail, HasSubstr("truncated"));
        }
    }
}

TEST_F(ImageFile, a_broken_byte_never_crashes_the_reader) {
    const Rgb8Image image = noise(40, 30);
    for (const char* name : {"a.png", "a.jpg", "a.webp", "a.tif"}) {
        write_foreign(at(name), 40, 30, 3, OIIO::TypeDesc::UINT8, image.bytes.data());
        const std::string whole = bytes_of(at(name));
        for (int i = 0; i < 60; ++i) {
            std::string broken = whole;
            const std::uint64_t bits = hash(5, 6, i, 0);
            // Most headers are in the first hundred bytes
            broken[bits % (i % 2 == 0 ? 100 : broken.size())] = static_cast<char>(bits >> 32);
            write_bytes(at(name), broken);
            const auto pattern = read_rgba_image(at(name), {.max_texels = 1 << 20});
            EXPECT_LE(pattern ? std::int64_t{pattern->width} * pattern->height : 0, 1 << 20);
            const auto read = read_rgb_image(at(name), {.max_texels = 1 << 20});
            EXPECT_LE(read ? std::int64_t{read->width} * read->height : 0, 1 << 20)
                << name << ", round " << i;
        }
    }
}

/// The same PNG, but declared `width`×`height`, with a checksum that fits.
std::string with_size(std::string png, std::uint32_t width, std::uint32_t height) {
    for (std::size_t i = 0; i < 4; ++i) {
        png[16 + i] = static_cast<char>(width >> (24 - 8 * i));
        png[20 + i] = static_cast<char>(height >> (24 - 8 * i));
    }
    std::uint32_t crc = 0xffffffff;
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= static_cast<unsigned char>(png[i]);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<char>(~crc >> (24 - 8 * i));
    return png;
}

TEST_F(ImageFile, a_header_that_declares_too_much_is_refused_before_a_texel_is_decoded) {
    ASSERT_TRUE(write_rgb_png(at("small.png"), noise(16, 16)));
    const std::string png = bytes_of(at("small.png"));
    write_bytes(at("same.png"), with_size(png, 16, 16));
    ASSERT_TRUE(read_rgb_image(at("same.png"))) << "the crafted header is not a valid one";
    write_bytes(at("huge.png"), with_size(png, 60000, 60000));
    expect_refused(at("huge.png"), ErrorCode::invalid_input, "more than the limit of 32768 a side");
    write_bytes(at("large.png"), with_size(png, 30000, 30000));
    expect_refused(at("large.png"), ErrorCode::invalid_input, "67108864 in all; scale it down");
    write_bytes(at("bomb.png"), with_size(png, 8000, 8000));
    expect_refused(at("bomb.png"), ErrorCode::invalid_input, "truncated or made to exhaust memory");
}

TEST_F(ImageFile, limits_hold_for_every_format) {
    const Rgb8Image image = noise(120, 90);
    for (const char* name : {"a.png", "a.jpg", "a.webp", "a.tif"}) {
        write_foreign(at(name), 120, 90, 3, OIIO::TypeDesc::UINT8, image.bytes.data());
        ASSERT_TRUE(read_rgb_image(at(name), {.max_texels = 120 * 90, .max_side = 120}));
        expect_refused(at(name), ErrorCode::invalid_input, "is 120×90 texels, more than the limit",
                       {.max_texels = 120 * 90 - 1});
        EXPECT_THAT(read_rgba_image(at(name), {.max_texels = 120 * 90 - 1}).error().detail,
                    HasSubstr("is 120×90 texels, more than the limit"));
        expect_refused(at(name), ErrorCode::invalid_input, "is 120×90 texels, more than the limit",
                       {.max_side = 119});
        expect_refused(at(name), ErrorCode::invalid_input, "bytes, more than the limit of 100",
                       {.max_file_bytes = 100});
    }
}

TEST_F(ImageFile, samples_that_are_no_8_or_16_bits_are_refused) {
    const std::vector<float> samples(3 * 4, 0.5F);
    write_foreign(at("float.tif"), 2, 2, 3, OIIO::TypeDesc::FLOAT, samples.data());
    expect_refused(at("float.tif"), ErrorCode::invalid_input, "save it with 8 or 16 bits");
}

TEST_F(ImageFile, labels_are_grey_pngs_only) {
    const Rgb8Image image = noise(8, 8);
    ASSERT_TRUE(write_rgb_png(at("rgb.png"), image));
    write_foreign(at("grey.jpg"), 8, 8, 1, OIIO::TypeDesc::UINT8, image.bytes.data());
    write_foreign(at("alpha.png"), 4, 4, 2, OIIO::TypeDesc::UINT8, image.bytes.data());
    for (const char* name : {"rgb.png", "grey.jpg", "alpha.png"}) {
        const auto read = read_label_image(at(name));
        ASSERT_FALSE(read) << name;
        EXPECT_THAT(read.error().detail, HasSubstr(at(name).string() + ": is no grey PNG of 8 or 16 bits"));
    }
}

TEST_F(ImageFile, a_place_that_cannot_be_written_is_named) {
    const auto written = write_rgb_png(at("none") / "image.png", noise(2, 2));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::io_failure);
    EXPECT_THAT(written.error().detail, HasSubstr("image.png: No such file or directory"));
}

}  // namespace
}  // namespace tessera
