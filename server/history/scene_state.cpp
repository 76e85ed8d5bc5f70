#include "server/history/scene_state.h"

#include <algorithm>

#include <google/protobuf/util/message_differencer.h>

#include "shared/wire/sprite_message.h"

namespace tessera {

SceneState state_of(const LiveScene& scene) {
    const ScenePtr now = scene.now();
    constexpr std::int64_t everywhere = std::int64_t{1} << 41;
    SceneState state;
    for (const Sprite& sprite : now->sprites.meeting({-everywhere, -everywhere, everywhere, everywhere}))
        write_sprite(sprite, state.sprites.emplace_back());
    std::sort(state.sprites.begin(), state.sprites.end(),
              [](const auto& a, const auto& b) { return a.id() < b.id(); });
    return state;
}

bool operator==(const SceneState& a, const SceneState& b) {
    return std::equal(a.sprites.begin(), a.sprites.end(), b.sprites.begin(), b.sprites.end(),
                      [](const auto& one, const auto& other) {
                          return google::protobuf::util::MessageDifferencer::Equals(one, other);
                      });
}

}  // namespace tessera
