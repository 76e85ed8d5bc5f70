#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "shared/result/result.h"

namespace tessera {

/// The content behind `content_encoding` ("" or "identity": `body` itself; "zstd": unpacked). More than
/// `max_bytes` of content, damaged data, or another encoding is `io_failure`; memory stays below `max_bytes`
/// whatever the data claims.
Result<std::string> decode_body(std::string body, std::string_view content_encoding, std::size_t max_bytes);

}  // namespace tessera
