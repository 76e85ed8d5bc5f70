#pragma once

#include <cstdint>

#include "server/prepare/perceptual.h"
#include "server/prepare/tile.h"

namespace tessera {

/// Makes the square of side + overlap texels at `place` of the photograph periodic: its right columns are
/// laid over its left ones and its bottom rows over its top ones, each divided by a minimum cut. The second
/// of them closes on itself round the torus: at the tile's first column it runs before row `pinned`, 1 to
/// overlap − 1.
PeriodicTile cut_on_torus(const PerceptualImage& photo, PhotoPoint place, std::int32_t side,
                          std::int32_t overlap, std::int32_t pinned);

}  // namespace tessera
