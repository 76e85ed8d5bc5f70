#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/patches.h"
#include "shared/result/result.h"

namespace tessera {

/// The patches of a hand-painted map of `side`×`side` labels, any numbers: one for each label, in the order
/// in which they are met from the top. Errors: invalid_input (a label in several pieces on the torus, or
/// wider than half the tile), which names label and place.
Result<Segmentation> painted_patches(const std::vector<std::uint16_t>& map, std::int32_t side);

}  // namespace tessera
