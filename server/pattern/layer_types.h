#pragma once

#include <memory>
#include <span>

#include "server/pattern/texel_range.h"
#include "server/pattern/typed_texture.h"

namespace tessera {

/// One layer of a stack whose cells are decided by the types of one quadtree.
struct TypedLayer {
    const ReferencePlan* reference = nullptr;  ///< Typed or constant, on the common grid; or
    std::array<float, 4> color{};              ///< one colour everywhere, linear and premultiplied.
};

/// Whether a reference texture can be part of such a stack: its cells are functions of their types, and
/// nothing hangs over.
bool is_typed_layer(const ReferencePlan& plan);

/// The cells of the whole stack, from the ground up: composited at level 0 once for each type, then reduced.
/// Null if that would take too long (more than about a second) or too much memory: cells above 1024 texels,
/// or 2^28 texels of different cells and layers.
std::shared_ptr<const TypeImages> make_layer_types(const Grid& grid, std::span<const TypedLayer> layers);

}  // namespace tessera
