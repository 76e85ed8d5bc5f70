#pragma once

#include <filesystem>

#include "shared/page/texel_image.h"
#include "shared/result/result.h"

namespace tessera {

/// Writes the colours of an opaque picture as an 8-bit RGB PNG. Error: io_failure.
Result<void> write_png(const std::filesystem::path& file, const Rgba8Image& image);

}  // namespace tessera
