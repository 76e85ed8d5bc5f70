#include "server/sprites/sprite_images.h"

#include <algorithm>

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
      cache_bytes_{cache_bytes} {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_) * static_cast<std::size_t>(slices_); ++i)
        seen_.push_back(seen_of(i));
}

SpriteImages::Seen SpriteImages::seen_of(std::size_t image) const {
    const auto side = static_cast<std::size_t>(side_);
    const std::uint16_t* texel = steps_.data() + image * side * side * 4;
    Seen seen{side_, side_, 0, 0};
    for (std::int32_t y = 0; y < side_; ++y)
        for (std::int32_t x = 0; x < side_; ++x, texel += 4) {
            if ((texel[0] | texel[1] | texel[2] | texel[3]) == 0) continue;
            seen.x0 = std::min(seen.x0, x), seen.x1 = std::max(seen.x1, x + 1);
            seen.y0 = std::min(seen.y0, y), seen.y1 = y + 1;
        }
    return seen;
}

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
    const auto placed = [&](const SpriteImage& image) {
        return SpriteImage{image.image, (x >> 8) + image.left, (y >> 8) + image.top};
    };
    {
        const std::lock_guard lock{mutex_};
        if (const auto kept = by_key_.find(key); kept != by_key_.end()) {
            kept_.splice(kept_.begin(), kept_, kept->second);
            return placed(kept->second->image);
        }
    }
    const SpriteImage drawn = render(key, key.part_x == 0 && key.part_y == 0 ? square : square + 1);
    const SpriteImage found = placed(drawn);
    const std::lock_guard lock{mutex_};
    if (by_key_.contains(key)) return found;
    kept_.push_front({key, drawn});
    by_key_.emplace(key, kept_.begin());
    kept_bytes_ += found.image->memory_bytes();
    while (kept_bytes_ > cache_bytes_ && kept_.size() > 1) {
        kept_bytes_ -= kept_.back().image.image->memory_bytes();
        by_key_.erase(kept_.back().key);
        kept_.pop_back();
    }
    return found;
}

SpriteImage SpriteImages::render(const Key& key, std::int32_t width) const {
    const std::int32_t square = bounding_side(side_, scale_of(key.scale), turns_of(key.turn));
    const double middle_x = 0.5 * square + key.part_x / static_cast<double>(sprite_units);
    const double middle_y = 0.5 * square + key.part_y / static_cast<double>(sprite_units);
    // What is not transparent, and the half texel around it that fades out, turned and scaled
    const auto image = static_cast<std::size_t>(key.image);
    const Seen& seen = seen_[image];
    const Turning t = turning(turns_of(key.turn));
    double left = width, top = width, right = 0, bottom = 0;
    for (const double u : {seen.x0 - 0.5, seen.x1 + 0.5})
        for (const double v : {seen.y0 - 0.5, seen.y1 + 0.5}) {
            const double i = (u - 0.5 * side_) * scale_of(key.scale),
                         j = (v - 0.5 * side_) * scale_of(key.scale);
            const double x = middle_x + t.cosine * i - t.sine * j, y = middle_y + t.sine * i + t.cosine * j;
            left = std::min(left, x), right = std::max(right, x);
            top = std::min(top, y), bottom = std::max(bottom, y);
        }
    // A texel more on each side, so that no rounding cuts
    const auto within = [width](double at) {
        return static_cast<std::int32_t>(std::clamp(at, 0.0, static_cast<double>(width)));
    };
    const std::int32_t x0 = within(left - 1), y0 = within(top - 1);
    if (seen.x1 == 0) return {std::make_shared<SummedArea>(1, 1), 0, 0};
    const std::int32_t x1 = within(right + 2), y1 = within(bottom + 2), longest = std::max(x1 - x0, y1 - y0);

    TurnedImage turned{{.side = side_,
                        .scale = scale_of(key.scale),
                        .turns = turns_of(key.turn),
                        .width = longest,
                        .middle_x = middle_x - x0,
                        .middle_y = middle_y - y0}};
    const auto side = static_cast<std::size_t>(side_);
    auto drawn = std::make_shared<SummedArea>(x1 - x0, y1 - y0);
    std::vector<std::uint16_t> row(static_cast<std::size_t>(longest) * 4);
    for (std::int32_t y = 0; y < y1 - y0; ++y) {
        turned.set_row(y);
        turned.sum(steps_.data() + image * side * side * 4, row.data());
        drawn->set_row(y, row.data());
    }
    return {drawn, x0, y0};
}

}  // namespace tessera
