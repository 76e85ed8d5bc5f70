#include "server/edits/sprite_book.h"

#include <string>
#include <utility>

namespace tessera {

namespace {

constexpr std::int64_t everywhere = std::int64_t{1} << 41;

Error no_such_sprite(SpriteId id) {
    return {ErrorCode::invalid_input,
            "there is no sprite " + std::to_string(id) + "; somebody may have removed it"};
}

}  // namespace

SpriteBook::SpriteBook(PositioningMap map) : map_{std::move(map)} {
    corners_.reserve(map_.size());
    for (const Sprite& sprite : map_.meeting({-everywhere, -everywhere, everywhere, everywhere})) {
        const TexelBox box = box_of(sprite);
        corners_.emplace(sprite.id, Corner{box.x0, box.y0});
    }
}

std::optional<Sprite> SpriteBook::find(SpriteId id) const {
    const auto corner = corners_.find(id);
    if (corner == corners_.end()) return std::nullopt;
    const auto [x, y] = corner->second;
    for (Sprite& sprite : map_.meeting({x, y, x + 1, y + 1}))
        if (sprite.id == id) return std::move(sprite);
    return std::nullopt;
}

Result<void> SpriteBook::place(const Sprite& sprite) {
    if (corners_.contains(sprite.id))
        return Error{ErrorCode::invalid_input, "there is a sprite " + std::to_string(sprite.id) +
                                                   " already; move it, or take another id"};
    if (auto placed = map_.place(sprite); !placed) return placed;
    const TexelBox box = box_of(sprite);
    corners_.emplace(sprite.id, Corner{box.x0, box.y0});
    return {};
}

Result<void> SpriteBook::replace(const Sprite& sprite) {
    const std::optional<Sprite> old = find(sprite.id);
    if (!old) return no_such_sprite(sprite.id);
    // It must not be in its own way
    const PositioningMap before = map_;
    map_.remove(*old);
    if (auto placed = map_.place(sprite); !placed) {
        map_ = before;
        return placed;
    }
    const TexelBox box = box_of(sprite);
    corners_[sprite.id] = {box.x0, box.y0};
    return {};
}

Result<void> SpriteBook::remove(SpriteId id) {
    const std::optional<Sprite> old = find(id);
    if (!old) return no_such_sprite(id);
    map_.remove(*old);
    corners_.erase(id);
    return {};
}

std::size_t SpriteBook::memory_bytes() const noexcept {
    return map_.memory_bytes() + corners_.bucket_count() * (sizeof(SpriteId) + sizeof(Corner) + 1);
}

}  // namespace tessera
