#include "server/blocks/row_hash.h"

namespace tessera {

std::uint32_t redraw(RowKey key, std::uint32_t x, std::uint32_t count) noexcept {
    return uniform_below(mix(key.whole + 0x9e3779b97f4a7c15u * (std::uint64_t{x} + 1)), count);
}

}  // namespace tessera
