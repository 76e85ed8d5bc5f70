#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/page/texel_image.h"
#include "shared/result/result.h"

namespace tessera {

/// An image that filters are compared on: a square of side 2^k, 2 to 2048 texels, opaque, sRGB-coded.
struct CompareTexture {
    std::string name;
    Rgba8Image image;
    std::string cropped;  ///< "photo.png: its upper left 512×512 of 600×540 texels"; empty: all of it.
};

/// Every NAME.png of a folder, by name; the largest square of side 2^k of each, since it has to repeat on all
/// levels. Transparent texels are shown over black. Error: invalid_input (no such folder, no PNG in it, a
/// file that is none or is too large or small), naming file and fix.
Result<std::vector<CompareTexture>> read_textures(const std::filesystem::path& folder);

/// Black and white squares of 32 texels.
CompareTexture made_checker();

}  // namespace tessera
