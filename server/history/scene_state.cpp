#include "server/history/scene_state.h"

#include <algorithm>

#include <google/protobuf/util/message_differencer.h>

#include "server/scene/scene_document.h"

namespace tessera {

namespace {

using google::protobuf::util::MessageDifferencer;

void clear_entries(proto::ExplicitMap& map) {
    map.clear_image();
    map.clear_values();
    map.clear_width();
    map.clear_blank_code();
}

void clear_entries(proto::Block& block) {
    if (block.has_explicit_indirection_map()) clear_entries(*block.mutable_explicit_indirection_map());
    if (block.has_areas_map()) clear_entries(*block.mutable_areas_map());
    if (block.has_dithered_areas_map()) clear_entries(*block.mutable_dithered_areas_map()->mutable_areas());
    if (block.has_pixel_map()) {
        block.mutable_pixel_map()->clear_image();
        block.mutable_pixel_map()->clear_values();
        block.mutable_pixel_map()->clear_width();
    }
}

/// What holds when all its transitions are over; targets by id.
proto::Scene settled(proto::Scene scene) {
    for (proto::Block& block : *scene.mutable_pattern()->mutable_blocks()) {
        if (!block.has_animation_map()) continue;
        proto::AnimationMap& map = *block.mutable_animation_map();
        proto::AnimationMap::Change last;
        last.mutable_phase()->set_integer(0);
        last.mutable_rest()->set_integer(0);
        last.set_density(1);
        const auto take = [&](const auto& from) {
            if (from.has_phase()) *last.mutable_phase() = from.phase();
            if (from.has_rest()) *last.mutable_rest() = from.rest();
            if (from.has_density()) last.set_density(from.density());
        };
        take(map);
        for (const auto& change : map.changes()) take(change);
        map.clear_changes();
        *map.mutable_phase() = last.phase();
        *map.mutable_rest() = last.rest();
        map.set_density(last.density());
    }
    auto& targets = *scene.mutable_targets();
    std::sort(targets.begin(), targets.end(), [](const auto& a, const auto& b) { return a.id() < b.id(); });
    return scene;
}

bool same_maps(const SceneState& a, const SceneState& b) {
    if (!a.maps || !b.maps) return a.maps == b.maps;
    return std::equal(a.maps->begin(), a.maps->end(), b.maps->begin(), b.maps->end(),
                      [](const EditableMap& one, const EditableMap& other) {
                          return one.block == other.block && one.map.width == other.map.width &&
                                 one.map.values == other.map.values;
                      });
}

}  // namespace

SceneState state_of(const LiveScene& live) {
    proto::LiveState all = live.state();
    const ScenePtr now = live.now();
    SceneState state;
    state.sprites.assign(std::make_move_iterator(all.mutable_sprites()->begin()),
                         std::make_move_iterator(all.mutable_sprites()->end()));
    std::sort(state.sprites.begin(), state.sprites.end(),
              [](const auto& a, const auto& b) { return a.id() < b.id(); });
    if (all.has_scene())
        state.document = std::move(*all.mutable_scene());
    else if (now->document)
        state.document = *now->document->message();
    state.maps = now->editable_maps;
    if (state.maps)
        for (proto::Block& block : *state.document.mutable_pattern()->mutable_blocks())
            if (std::any_of(state.maps->begin(), state.maps->end(),
                            [&](const EditableMap& map) { return map.block == block.name(); }))
                clear_entries(block);
    state.clock = all.clock();
    return state;
}

bool alike(const SceneState& a, const SceneState& b) {
    return std::equal(
               a.sprites.begin(), a.sprites.end(), b.sprites.begin(), b.sprites.end(),
               [](const auto& one, const auto& other) { return MessageDifferencer::Equals(one, other); }) &&
           same_maps(a, b) && MessageDifferencer::Equals(settled(a.document), settled(b.document)) &&
           a.clock.playing() == b.clock.playing() &&
           a.clock.steps_per_second() == b.clock.steps_per_second() &&
           (a.clock.playing() || a.clock.step() == b.clock.step());
}

}  // namespace tessera
