#include "server/http/editables.h"

#include <algorithm>

#include "proto/editables.pb.h"

#include "server/blocks/editable_map.h"
#include "server/sprites/sprite_images.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

constexpr std::int32_t most_coded = 0xfffe;  ///< Of an entry that a MapPaint writes

void write_map(const EditableMap& editable, proto::EditableGrid& to) {
    const StoredMap& map = editable.map;
    const std::int64_t cell = std::int64_t{1} << editable.cell_log2;
    to.set_block(editable.block);
    to.set_x(map.x * cell);
    to.set_y(map.y * cell);
    to.set_entry_texels(static_cast<std::uint64_t>(cell << map.cells_log2));
    to.set_width(static_cast<std::uint32_t>(map.width));
    to.set_height(static_cast<std::uint32_t>(map.height));
    to.set_least(map.bounded() ? std::max(map.least, 0) : 0);
    to.set_most(map.bounded() ? map.most : most_coded);
    if (!map.bounded() && !map.values.distinct().empty()) to.set_most(map.values.distinct().back());
    to.set_repeats(map.edge == StoredMap::Edge::wrap);
    to.set_corners(editable.between_x || editable.between_y);
}

void write_animation(const proto::Block& block, proto::SceneEditables& to) {
    const proto::AnimationMap& map = block.animation_map();
    if (map.driver_case() != proto::AnimationMap::DRIVER_NOT_SET) return;
    if (std::ranges::find(block.editable(), "animation") == block.editable().end()) return;
    proto::EditableAnimation& animation = *to.add_animations();
    animation.set_block(block.name());
    double density = map.has_density() ? map.density() : 1;
    for (const auto& change : map.changes())
        if (change.has_density()) density = change.density();
    animation.set_density(density);
}

void write_frames(const SpriteFrames& frames, proto::SpriteAnimation& to) {
    for (std::int32_t i = 0; i < frames.line.frames(); ++i) {
        proto::SpriteAnimation::Frame& frame = *to.add_frames();
        frame.set_pattern(static_cast<std::uint32_t>(frames.patterns[static_cast<std::size_t>(i)]));
        const std::int64_t steps =
            frames.line.end_of(i) - frames.line.begin_of(i) + (i == 0 ? frames.line.lead() : 0);
        if (steps != 1) frame.set_steps(static_cast<std::uint32_t>(steps));
    }
}

}  // namespace

std::string describe_editables(const Scene& scene) {
    proto::SceneEditables editables;
    editables.set_revision(scene.revision);
    if (scene.editable_maps)
        for (const EditableMap& map : *scene.editable_maps) write_map(map, *editables.add_maps());
    if (scene.message) {
        for (const proto::Block& block : scene.message->pattern().blocks())
            if (block.has_animation_map()) write_animation(block, editables);
        *editables.mutable_targets() = scene.message->targets();
    }
    if (scene.sprite_images)
        for (const auto& frames : scene.sprite_images->animations())
            write_frames(*frames, *editables.add_sprite_animations());
    return write_brief_json(editables);
}

}  // namespace tessera
