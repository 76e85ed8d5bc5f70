#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/pattern/pattern_texture.h"
#include "shared/motion/targets.h"
#include "shared/page/texel_box.h"

namespace tessera {

/// `pattern`, made of `plan`, with the scene's targets: it looks at them as the plan's laws say. `pattern`
/// itself where there are no such laws.
///
/// A region that no target ever comes near costs and shows what it does without targets, at every step. Up to
/// the level of the cells that look at targets, cells look for themselves. Above, what cells near targets
/// change is summed, as sprites are (DESIGN section 2): exact to within the bounds of what is there far from
/// targets, and at the cost of the cells that targets reach. Where those are more than the budget allows (16
/// million for `exact`, 4 million for `high`, one for `fast`), they are left out, within a certain bound.
std::shared_ptr<const Texture> make_targeted_texture(std::shared_ptr<const Texture> pattern, const Plan& plan,
                                                     std::span<const MovingTarget> targets);

/// A texture that make_targeted_texture() made, with other targets: shares everything else with it, and takes
/// no time. Any other texture as it is.
std::shared_ptr<const Texture> with_targets(std::shared_ptr<const Texture> texture,
                                            std::span<const MovingTarget> targets);

/// Whether the step decides what it shows of its targets.
bool moved_by_targets(const Texture& texture) noexcept;

/// The texels of level 0 that a target may change at any step, a box for each leg; none where the texture
/// does not look at targets.
std::vector<TexelBox> texels_near(const Texture& texture, const MovingTarget& target);

}  // namespace tessera
