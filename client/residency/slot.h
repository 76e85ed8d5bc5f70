#pragma once

#include <cstdint>

namespace tessera {

/// A place for one page in the cache: a layer of the array texture. 0 to the cache's capacity − 1, below
/// 65,535.
using Slot = std::uint16_t;

}  // namespace tessera
