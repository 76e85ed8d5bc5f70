#pragma once

#include <cstdint>

namespace tessera {

/// Counts the accepted edits of a scene: 0 before the first, then one more for each, without gaps.
using Revision = std::uint64_t;

}  // namespace tessera
