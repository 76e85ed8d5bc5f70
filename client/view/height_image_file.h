#pragma once

#include <filesystem>
#include <memory>

#include "client/residency/height_field.h"
#include "shared/result/result.h"

namespace tessera {

/// A grey picture as heights: a PNG of 8 or 16 bits, 2 to 8192 pixels each way. Error: invalid_input, naming
/// the file.
Result<std::shared_ptr<const HeightImage>> read_height_image(const std::filesystem::path& file);

}  // namespace tessera
