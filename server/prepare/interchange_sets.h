#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/interchange_patch.h"
#include "server/texture/exchange_asset.h"

namespace tessera {

/// Whether patch a, on a tile, and patch b, on any of that tile's four edge neighbours, have a texel in
/// common.
bool overlap_on_neighbours(const InterchangePatch& a, const InterchangePatch& b, std::int32_t tile_side);

/// Divides patches into sets a and b such that none of a, on a tile, overlaps one of b on an edge neighbour.
/// Diagonal neighbours show the same set, and never meet there, since both keep to the rhombus; patches that
/// leave it are in neither set. Kolář et al. 2016, algorithm 1, but for this: the paper adds random patches,
/// one to each list in turn, until there are enough, which may be never; here every patch is tried once, in
/// hashed order, for the shorter list first. What does not fit a list then never will, so both end as long as
/// they can get.
std::vector<ExchangeAsset::Set> divide_into_sets(const std::vector<InterchangePatch>& patches,
                                                 std::int32_t tile_side, std::uint64_t seed);

}  // namespace tessera
