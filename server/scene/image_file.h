#pragma once

#include <cstdint>
#include <filesystem>

#include "server/texture/exchange_asset.h"
#include "server/texture/rgb8_image.h"
#include "shared/result/result.h"

namespace tessera {

/// What an image file may cost before one of its texels is decoded.
struct ImageLimits {
    std::int64_t max_texels = std::int64_t{1}
                              << 26;  ///< 64 Mtexel: 8192². Too little refuses real photographs.
    std::int32_t max_side = 32768;
    std::int64_t max_file_bytes = std::int64_t{1} << 28;
    const char* how_to_raise = "";  ///< Ends the sentence for whoever is above max_texels: ", or …".
};

/// Reads a PNG, JPEG, WebP or TIFF, told apart by its first bytes and never by its name, as 8-bit sRGB. Grey
/// becomes RGB, 16 bits are rounded to 8, opaque alpha is dropped; transparency is an error. Errors name the
/// file.
Result<Rgb8Image> read_rgb_image(const std::filesystem::path& file, const ImageLimits& limits = {});

/// Texels of a pattern as files hold them: sRGB codes, alpha straight; rows from the top.
struct StraightRgba8Image {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t> bytes;  ///< 4·width·height
};

/// The same with transparency: what has none is opaque. Premultiplied TIFFs are divided by their alpha.
Result<StraightRgba8Image> read_rgba_image(const std::filesystem::path& file, const ImageLimits& limits = {});

/// Reads an 8- or 16-bit grey PNG as it is: labels.
struct LabelImage {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint16_t> labels;
};
Result<LabelImage> read_label_image(const std::filesystem::path& file, const ImageLimits& limits = {});

/// Reads a grey PNG of 1 or 8 bits: shapes. What is lighter than half is inside.
Result<BitMask> read_bit_image(const std::filesystem::path& file, const ImageLimits& limits = {});

Result<void> write_rgb_png(const std::filesystem::path& file, const Rgb8Image& image);
Result<void> write_rgba_png(const std::filesystem::path& file, const StraightRgba8Image& image);
Result<void> write_label_png(const std::filesystem::path& file, const LabelImage& image);
Result<void> write_bit_png(const std::filesystem::path& file, const BitMask& image);

}  // namespace tessera
