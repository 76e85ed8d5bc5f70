#pragma once

#include <memory>

#include "server/blocks/plan.h"
#include "server/pattern/instance_images.h"
#include "server/pattern/pattern_texture.h"
#include "server/pattern/typed_texture.h"

namespace tessera {

/// A reference texture with a transform: patterns moved, turned and scaled. `plan.transform` is set, and
/// InstanceImages::bytes(plan) is affordable.
/// `images`: of the plan; null: they are made.
std::shared_ptr<const PatternTexture> make_instance_texture(
    const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images = nullptr);

/// What the cells of a typed (or constant) reference texture with a constrained transform look like.
/// `images`: of the plan.
std::shared_ptr<const TypeImages> make_instance_types(const ReferencePlan& plan,
                                                      std::shared_ptr<const InstanceImages> images);

}  // namespace tessera
