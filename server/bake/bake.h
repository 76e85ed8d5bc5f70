#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "server/texture/texture.h"
#include "shared/page/error_limit.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// The longest side that `bake` writes: a band of rows of it is held in memory, never the whole.
inline constexpr std::int64_t max_bake_side = std::int64_t{1} << 18;

/// What holds of every texel of the file.
struct Baked {
    double bound_codes = 0;
    double confidence = 1;
    bool within_limit = true;  ///< Whether all bounds keep the limit that was asked for.
};

/// Writes `region` to a file whose ending names what it holds:
///   .png  8-bit sRGB, straight alpha
///   .exr  half floats, linear, premultiplied
///   .tx   tiled TIFF for renderers, 8-bit sRGB, with every MIP level down to one texel, each evaluated and
///         not reduced; the region must be a square of 2^k texels at a multiple of its side
/// TexelKind::data has no sRGB coding in any of them, and the files do not claim one.
/// The file appears whole or not at all. `progress` is told the share that is done, 0 to 1.
/// With a limit, band by band at the cheapest accuracy that keeps it, else at the budget's.
/// Errors: invalid_input, io_failure, and the texture's own.
Result<Baked> bake(const Texture& texture, const TexelRegion& region, std::optional<ErrorLimit> limit,
                   const Budget& budget, const std::filesystem::path& file,
                   const std::function<void(double)>& progress);

}  // namespace tessera
