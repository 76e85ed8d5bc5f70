#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// How often each level is asked for.
struct LevelWeight {
    std::uint8_t level = 0;
    std::uint32_t weight = 1;  ///< 1 to 1,000,000; a share is a weight over the sum of all.
    bool operator==(const LevelWeight&) const = default;
};

/// Reads `LEVEL`, `A-B` or a list of them with weights, as in "0-3=4,4-8=1": each of the levels 0 to 3 is
/// asked for four times as often as each of 4 to 8. The empty text is every level of the extent, with equal
/// weights. Ascending; a level that is named twice, or that the extent does not have, is `invalid_input`.
Result<std::vector<LevelWeight>> parse_level_weights(std::string_view text, Extent extent);

}  // namespace tessera
