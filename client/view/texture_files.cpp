#include "client/view/texture_files.h"

#include <algorithm>
#include <bit>

#include <png.h>

#include "client/render/whole_texture.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr png_uint_32 most_texels_a_side = 8192;

Error wrong(const fs::path& file, const std::string& why) {
    return {ErrorCode::invalid_input, "--textures: " + file.string() + ": " + why};
}

Result<CompareTexture> read_texture(const fs::path& file) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&png, file.c_str()))
        return wrong(file, std::string{"is no PNG image: "} + png.message);
    const auto size = std::to_string(png.width) + "×" + std::to_string(png.height);
    const png_uint_32 shorter = std::min(png.width, png.height);
    if (png.width > most_texels_a_side || png.height > most_texels_a_side || shorter < 2) {
        png_image_free(&png);
        return wrong(file, "is " + size + " texels; each side must have 2 to 8192");
    }
    png.format = PNG_FORMAT_RGB;
    constexpr png_color black{};
    const auto row = std::size_t{3} * png.width;
    std::vector<std::uint8_t> texels(row * png.height);
    if (!png_image_finish_read(&png, &black, texels.data(), 0, nullptr))
        return wrong(file, std::string{"cannot be read: "} + png.message);

    const auto side = static_cast<std::int32_t>(
        std::min(std::bit_floor(shorter), static_cast<png_uint_32>(WholeTexture::most_side)));
    CompareTexture texture{file.stem().string(), {side, side}, {}};
    for (std::int32_t y = 0; y < side; ++y) {
        const std::uint8_t* from = texels.data() + row * static_cast<std::size_t>(y);
        std::uint8_t* to = texture.image.row(y);
        for (std::int32_t x = 0; x < side; ++x, from += 3, to += 4) {
            std::copy_n(from, 3, to);
            to[3] = 255;
        }
    }
    if (side != static_cast<std::int32_t>(png.width) || side != static_cast<std::int32_t>(png.height))
        texture.cropped = file.filename().string() + ": its upper left " + std::to_string(side) + "×" +
                          std::to_string(side) + " of " + size + " texels";
    return texture;
}

}  // namespace

Result<std::vector<CompareTexture>> read_textures(const fs::path& folder) {
    std::error_code failed;
    if (!fs::is_directory(folder, failed))
        return wrong(folder, "is no folder; name one that holds PNG images");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator{folder, failed})
        if (entry.path().extension() == ".png") files.push_back(entry.path());
    if (failed) return wrong(folder, "cannot be read: " + failed.message());
    if (files.empty()) return wrong(folder, "holds no PNG image");
    std::ranges::sort(files);
    std::vector<CompareTexture> textures;
    for (const fs::path& file : files) {
        auto texture = read_texture(file);
        if (!texture) return texture.error();
        textures.push_back(std::move(*texture));
    }
    return textures;
}

CompareTexture made_checker() {
    constexpr std::int32_t side = 256, square = 32;
    CompareTexture texture{"checker", {side, side}, {}};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            std::uint8_t* texel = texture.image.row(y) + 4 * x;
            std::fill_n(texel, 3, (x / square + y / square) % 2 == 0 ? 255 : 0);
            texel[3] = 255;
        }
    return texture;
}

}  // namespace tessera
