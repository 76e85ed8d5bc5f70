#include "client/view/height_image_file.h"

#include <string>

#include <png.h>

namespace tessera {
namespace {

constexpr png_uint_32 most_pixels_a_side = 8192;

Error wrong(const std::filesystem::path& file, const std::string& why) {
    return {ErrorCode::invalid_input, "--terrain: " + file.string() + ": " + why};
}

}  // namespace

Result<std::shared_ptr<const HeightImage>> read_height_image(const std::filesystem::path& file) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&png, file.c_str()))
        return wrong(file, std::string{"is no PNG image: "} + png.message);
    if (png.width < 2 || png.height < 2 || png.width > most_pixels_a_side ||
        png.height > most_pixels_a_side) {
        png_image_free(&png);
        return wrong(file, "is " + std::to_string(png.width) + "×" + std::to_string(png.height) +
                               " pixels; each side must have 2 to 8192");
    }
    // Codes as they stand in the file: neither kind is decoded
    const bool is_deep = (png.format & PNG_FORMAT_FLAG_LINEAR) != 0;
    png.format = is_deep ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    const std::size_t pixels = std::size_t{png.width} * png.height;
    std::vector<std::uint16_t> codes(pixels);
    std::vector<std::uint8_t> bytes(is_deep ? 0 : pixels);
    constexpr png_color black{};
    void* target = is_deep ? static_cast<void*>(codes.data()) : bytes.data();
    if (!png_image_finish_read(&png, &black, target, 0, nullptr))
        return wrong(file, std::string{"cannot be read: "} + png.message);
    for (std::size_t i = 0; i < bytes.size(); ++i) codes[i] = static_cast<std::uint16_t>(257 * bytes[i]);
    return std::make_shared<const HeightImage>(static_cast<std::int32_t>(png.width),
                                               static_cast<std::int32_t>(png.height), std::move(codes));
}

}  // namespace tessera
