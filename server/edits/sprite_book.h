#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <boost/unordered/unordered_flat_map.hpp>

#include "shared/sprites/positioning_map.h"

namespace tessera {

/// The sprites of a scene as its editor sees them: by id. What pages see is a copy of map().
class SpriteBook {
  public:
    explicit SpriteBook(PositioningMap map = PositioningMap{});

    const PositioningMap& map() const noexcept { return map_; }

    std::optional<Sprite> find(SpriteId id) const;

    /// Error: invalid_input (PositioningMap::place; there is such a sprite already).
    Result<void> place(const Sprite& sprite);

    /// Puts `sprite` where one of its id is. Error: as place(); nothing has changed then.
    Result<void> replace(const Sprite& sprite);

    /// Error: invalid_input, if there is no such sprite.
    Result<void> remove(SpriteId id);

    std::size_t memory_bytes() const noexcept;

  private:
    /// A texel that the sprite's box holds: enough to find it in the map.
    struct Corner {
        std::int64_t x = 0, y = 0;
    };

    PositioningMap map_;
    boost::unordered_flat_map<SpriteId, Corner> corners_;
};

}  // namespace tessera
