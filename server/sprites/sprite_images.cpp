#include "server/sprites/sprite_images.h"

#include "server/filter/turned_image.h"
#include "server/pattern/premultiplied_steps.h"
#include "shared/math/hash.h"

namespace tessera {

namespace {

constexpr double turns_of(std::uint16_t turn) noexcept { return turn / 65536.0; }
constexpr double scale_of(std::uint32_t scale) noexcept {
    return scale / static_cast<double>(sprite_scale_one);
}

}  // namespace

std::size_t SpriteImages::KeyHash::operator()(const Key& key) const noexcept {
    return hash(0, 0, std::int64_t{key.image} << 32 | key.scale,
                std::int64_t{key.turn} << 32 | std::int64_t{key.part_x} << 16 | key.part_y);
}

SpriteImages::SpriteImages(const PatternImages& patterns, std::size_t cache_bytes,
                           std::vector<std::shared_ptr<const SpriteFrames>> animations)
    : side_{patterns.side},
      count_{patterns.count},
      slices_{patterns.slices},
      animations_{std::move(animations)},
      steps_{premultiplied_steps(patterns)},
      cache_bytes_{cache_bytes} {}

SpriteImage SpriteImages::of(const Sprite& sprite, std::int64_t slice, std::int64_t step) const {
    const SpritePosition middle = position_at(sprite, step);
    const std::int32_t square = bounding_side(side_, scale_of(sprite.scale), turns_of(sprite.turn));
    // The square's corner, down to a whole texel
    constexpr std::int64_t half = sprite_units / 2;
    static_assert(sprite_units == 256);
    const std::int64_t x = middle.x - square * half, y = middle.y - square * half;
    const Key key{.image = pattern_at(sprite, step) * slices_ +
                           static_cast<std::int32_t>((slice % slices_ + slices_) % slices_),
                  .scale = sprite.scale,
                  .turn = sprite.turn,
                  .part_x = static_cast<std::uint16_t>(x & (sprite_units - 1)),
                  .part_y = static_cast<std::uint16_t>(y & (sprite_units - 1))};
    SpriteImage found{nullptr, x >> 8, y >> 8};
    {
        const std::lock_guard lock{mutex_};
        if (const auto kept = by_key_.find(key); kept != by_key_.end()) {
            kept_.splice(kept_.begin(), kept_, kept->second);
            found.image = kept->second->image;
            return found;
        }
    }
    found.image = render(key, key.part_x == 0 && key.part_y == 0 ? square : square + 1);
    const std::lock_guard lock{mutex_};
    if (by_key_.contains(key)) return found;
    kept_.push_front({key, found.image});
    by_key_.emplace(key, kept_.begin());
    kept_bytes_ += found.image->memory_bytes();
    while (kept_bytes_ > cache_bytes_ && kept_.size() > 1) {
        kept_bytes_ -= kept_.back().image->memory_bytes();
        by_key_.erase(kept_.back().key);
        kept_.pop_back();
    }
    return found;
}

std::shared_ptr<const SummedArea> SpriteImages::render(const Key& key, std::int32_t width) const {
    const std::int32_t square = bounding_side(side_, scale_of(key.scale), turns_of(key.turn));
    TurnedImage turned{{.side = side_,
                        .scale = scale_of(key.scale),
                        .turns = turns_of(key.turn),
                        .width = width,
                        .middle_x = 0.5 * square + key.part_x / static_cast<double>(sprite_units),
                        .middle_y = 0.5 * square + key.part_y / static_cast<double>(sprite_units)}};
    const auto side = static_cast<std::size_t>(side_);
    const std::uint16_t* image = steps_.data() + static_cast<std::size_t>(key.image) * side * side * 4;
    auto drawn = std::make_shared<SummedArea>(width, width);
    std::vector<std::uint16_t> row(static_cast<std::size_t>(width) * 4);
    for (std::int32_t y = 0; y < width; ++y) {
        turned.set_row(y);
        turned.sum(image, row.data());
        drawn->set_row(y, row.data());
    }
    return drawn;
}

}  // namespace tessera
