#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "shared/result/result.h"

namespace tessera {

/// The tiles of a <data> or <chunk> element: exactly `count` numbers. `encoding` is "csv" or "base64",
/// `compression` "", "zlib", "gzip" or "zstd". Nothing is allocated beyond `count`, whatever the text claims.
/// Error: invalid_input; the reason alone.
Result<std::vector<std::uint32_t>> decode_layer(std::string_view text, std::string_view encoding,
                                                std::string_view compression, std::size_t count);

}  // namespace tessera
