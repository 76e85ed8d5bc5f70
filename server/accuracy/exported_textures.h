#pragma once

#include <filesystem>

#include "server/accuracy/accuracy_run.h"

namespace tessera {

/// Writes each stored texture (not scenes) as `folder`/NAME.png, 8-bit sRGB, so that a GPU client measures on
/// the same texels. Errors: io_failure, cancelled, and those of reading.
Result<void> export_textures(const AccuracyOptions& options, const std::filesystem::path& folder,
                             Progress& progress);

}  // namespace tessera
