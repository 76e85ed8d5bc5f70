#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/blocks/pattern_images.h"
#include "server/filter/summed_area.h"
#include "shared/sprites/sprite.h"

namespace tessera {

/// A sprite ready to be drawn: its turned, scaled pattern as far as it shows anything, and the texel of level
/// 0 of its top-left texel.
struct SpriteImage {
    std::shared_ptr<const SummedArea> image;
    std::int64_t left = 0, top = 0;
};

/// What sprites look like at level 0: the exact integral of the turned and scaled bilinear pattern over each
/// texel (turned_image.h), in linear light, premultiplied; a sprite at scale 1, turned by quarters and put on
/// whole texels, shows its pattern's texels. Hands put sprites anywhere, so images are made when they are
/// first asked for, and the latest are kept, up to `cache_bytes`. May be asked from several threads.
class SpriteImages {
  public:
    /// `animations`: those of the scene, which sprites may show.
    SpriteImages(const PatternImages& patterns, std::size_t cache_bytes,
                 std::vector<std::shared_ptr<const SpriteFrames>> animations = {});

    std::int32_t side() const noexcept { return side_; }
    std::int32_t count() const noexcept { return count_; }
    std::span<const std::shared_ptr<const SpriteFrames>> animations() const noexcept { return animations_; }

    /// Where the sprite is at `step`, and what it shows; its patterns exist. A set's slices follow each
    /// other, again and again.
    SpriteImage of(const Sprite& sprite, std::int64_t slice, std::int64_t step) const;

    std::size_t memory_bytes() const noexcept {
        return steps_.size() * sizeof(std::uint16_t) + seen_.size() * sizeof(Seen) + cache_bytes_;
    }

  private:
    /// All that an image depends on.
    struct Key {
        std::int32_t image = 0;
        std::uint32_t scale = 0;
        std::uint16_t turn = 0;
        std::uint16_t part_x = 0, part_y = 0;  ///< Of a texel, in units.
        bool operator==(const Key&) const = default;
    };
    struct KeyHash {
        std::size_t operator()(const Key& key) const noexcept;
    };
    struct Kept {
        Key key;
        SpriteImage image;  ///< From the corner of the sprite's square.
    };

    /// Of an image's texels those that are not transparent: [x0, x1) × [y0, y1), which may be empty.
    struct Seen {
        std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    };
    Seen seen_of(std::size_t image) const;
    SpriteImage render(const Key& key, std::int32_t width) const;

    std::int32_t side_, count_, slices_;
    std::vector<std::shared_ptr<const SpriteFrames>> animations_;
    std::vector<std::uint16_t> steps_;  ///< Of the patterns, premultiplied.
    std::vector<Seen> seen_;            ///< The same.
    std::size_t cache_bytes_;

    mutable std::mutex mutex_;      ///< Guards what follows; not held while rendering.
    mutable std::list<Kept> kept_;  ///< The latest first.
    mutable std::unordered_map<Key, std::list<Kept>::iterator, KeyHash> by_key_;
    mutable std::size_t kept_bytes_ = 0;
};

}  // namespace tessera
