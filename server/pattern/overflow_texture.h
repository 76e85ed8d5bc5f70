#pragma once

#include <memory>

#include "server/blocks/plan.h"
#include "server/pattern/instance_images.h"
#include "server/pattern/pattern_texture.h"

namespace tessera {

/// A reference texture whose instances hang over into the cells at their right and below (Lefebvre &
/// Neyret, 3.2, Tile Transform: "managing the overflow through multipass"). Up to four meet in a texel; later
/// ones, in reading order of cells, are composited over earlier ones.
///
/// Level 0 is exact. Above, box-filtered instances are composited with certain limits (mean_products.h), and
/// deeper where that is not good enough (descent.h). Above the cell the texture is the sum of all its
/// instances, exact or expected, less what they hide of each other, which is estimated from a sample of
/// cells.
/// `images`: of the plan; null: they are made.
std::shared_ptr<const PatternTexture> make_overflow_texture(
    const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images = nullptr);

}  // namespace tessera
