#include "server/pattern/map_states.h"

namespace tessera {

std::optional<MapStates> MapStates::of(const StoredMap& map) {
    constexpr std::int64_t most_apart = std::int64_t{1} << 22;
    constexpr std::size_t most_states = std::size_t{1} << 16;
    MapStates states;
    states.values_ = possible_values(map);
    const std::int64_t least = states.values_.front(), most = states.values_.back();
    if (most - least >= most_apart || states.values_.size() > most_states) return std::nullopt;
    states.numbers_.resize(static_cast<std::size_t>(most - least + 1));
    for (std::size_t i = 0; i < states.values_.size(); ++i)
        states.numbers_[static_cast<std::size_t>(states.values_[i] - least)] = static_cast<std::uint16_t>(i);
    return states;
}

}  // namespace tessera
