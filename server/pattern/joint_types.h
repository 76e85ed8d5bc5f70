#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "server/pattern/typed_texture.h"

namespace tessera {

/// A texture, or part of one, whose cells of some size are functions of their types in one quadtree: layers
/// and masks of them are drawn once for each type, and are then exact at every level. Exactly one is meant:
struct JointPart {
    const ReferencePlan* reference = nullptr;  ///< Typed or constant;
    const StoredMap* map = nullptr;            ///< `parts`, each where the map holds its number;
    std::vector<JointPart> parts{};            ///< layers, from the ground up;
    std::array<float, 4> color{};              ///< one colour everywhere, linear and premultiplied.
};

/// Whether a reference texture can be such a part: its cells are functions of their types, or all alike, and
/// nothing hangs over.
bool is_joint(const ReferencePlan& plan);
/// Whether a pixel map can: it repeats, after a power of two of texels.
bool is_joint(const StoredMap& map);

/// The cells that all parts have in common: as large as the largest cells, or period of a map, among them.
/// Nothing where the parts' quadtrees are not one, or their cells differ in slices, or would be larger than
/// 1024 texels.
std::optional<Grid> joint_grid(const JointPart& whole);

/// The cells of the whole: composited at level 0 once for each type, then reduced. Null if that would take
/// too long (more than about a second for a slice) or too much memory.
std::shared_ptr<const TypeImages> make_joint_types(const Grid& grid, const JointPart& whole);

}  // namespace tessera
