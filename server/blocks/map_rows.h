#pragma once

#include <algorithm>
#include <cstdint>

#include "server/blocks/stored_map.h"

namespace tessera {

/// Entries (i, j), (i + 1, j), …: `count` of them, with one division for all.
inline void read_entries(const StoredMap& map, std::int64_t i, std::int64_t j, std::int32_t count,
                         std::int32_t* out) noexcept {
    if (map.edge != StoredMap::Edge::wrap) {
        for (std::int32_t k = 0; k < count; ++k) out[k] = map.entry(i + k, j);
        return;
    }
    const std::int64_t row = StoredMap::wrapped(j, map.height);
    std::int64_t column = StoredMap::wrapped(i, map.width);
    for (std::int32_t done = 0; done < count;) {
        const auto run = static_cast<std::int32_t>(std::min<std::int64_t>(count - done, map.width - column));
        map.values.copy(static_cast<std::size_t>(row * map.width + column), static_cast<std::size_t>(run),
                        out + done);
        done += run;
        column = 0;
    }
}

}  // namespace tessera
