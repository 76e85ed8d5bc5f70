#include "client/view/png_file.h"

#include <vector>

#include <png.h>

namespace tessera {

Result<void> write_png(const std::filesystem::path& file, const Rgba8Image& image) {
    std::vector<std::uint8_t> rgb;
    rgb.reserve(image.bytes.size() / 4 * 3);
    for (std::size_t at = 0; at < image.bytes.size(); at += 4)
        rgb.insert(rgb.end(), {image.bytes[at], image.bytes[at + 1], image.bytes[at + 2]});
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    png.flags = PNG_IMAGE_FLAG_FAST;
    if (png_image_write_to_file(&png, file.c_str(), 0, rgb.data(), 0, nullptr)) return {};
    return Error{ErrorCode::io_failure, file.string() + ": cannot be written: " + png.message};
}

}  // namespace tessera
