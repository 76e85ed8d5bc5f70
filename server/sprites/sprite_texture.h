#pragma once

#include <memory>

#include "server/pattern/pattern_texture.h"
#include "server/sprites/sprite_images.h"
#include "shared/sprites/positioning_map.h"

namespace tessera {

/// Sprites over a ground (Lefebvre and Neyret 2003, section 3.2, explicit positioning and texture sprites;
/// DESIGN section 2, sprites). A page that meets no sprite is the ground's own, bit for bit and for nothing.
///
/// Level 0 is exact: premultiplied over, in the order of drawing. Above, a sprite is a signed stamp: what it
/// changes of its own few texels of level 0, summed. So the cost is that of the sprites' texels, not of the
/// page's. Sums are integers, and do not depend on the region. Where a page meets more than the budget allows
/// (16 million texels of level 0 for `exact`, 4 million for `high`, one for `fast`), sprites are laid over
/// the ground's mean instead, within a certain bound that counts how much of a texel they cover.
std::shared_ptr<const PatternTexture> make_sprite_texture(std::shared_ptr<const Texture> ground,
                                                          std::shared_ptr<const SpriteImages> images,
                                                          PositioningMap sprites);

}  // namespace tessera
