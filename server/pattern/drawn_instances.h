#pragma once

#include <memory>

#include "server/blocks/plan.h"
#include "server/pattern/instance_images.h"
#include "server/pattern/pattern_texture.h"

namespace tessera {

/// A reference texture with a constrained transform whose cells are drawn one by one. Up to the level of a
/// cell exact: box sums of the instances. Above it cells are summed while that is affordable, then expected
/// with a bound (area_expectation.h).
std::shared_ptr<const PatternTexture> make_drawn_instances(const ReferencePlan& plan,
                                                           std::shared_ptr<const InstanceImages> images);

}  // namespace tessera
