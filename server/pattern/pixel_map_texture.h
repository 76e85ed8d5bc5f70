#pragma once

#include <memory>
#include <vector>

#include "server/blocks/stored_map.h"
#include "server/pattern/layered_texture.h"

namespace tessera {

/// Textures with sharp masks (Lefebvre & Neyret, 3.3, Pixel Map): where the map shows i, parts[i] is shown.
/// Map entries cover 2^cells_log2 texels; `map.x` and `map.y` are 0. Each page evaluates only what it shows:
/// inside one family that family alone, as if there were no map. Where a texel holds entries of several
/// families, exact shares times the families' own filtered texels, with certain limits, and deeper where that
/// is not good enough (descent.h); or `joint`, if there is one: the whole as a texture that is exact at every
/// level. `parts` that the map never shows may be null. `law`: of the whole.
std::shared_ptr<const Texture> make_pixel_map_texture(const StoredMap& map, std::vector<Layer> parts,
                                                      std::shared_ptr<const Texture> joint = nullptr,
                                                      const std::optional<DrawLaw>& law = {});

}  // namespace tessera
