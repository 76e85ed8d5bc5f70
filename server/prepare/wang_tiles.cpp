#include "server/prepare/wang_tiles.h"

#include <algorithm>
#include <cstdlib>

#include "server/prepare/parallel.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::uint64_t sample_stream = stream("wang samples"), window_stream = stream("wang windows");

std::int32_t color_of(std::uint8_t corners, int corner) { return corners >> 2 * corner & 3; }

/// Three fifths of the places at random, so that not all that must fit alike is alike.
PlaceWindow window_at(const PlaceWindow& all, std::uint64_t bits) {
    PlaceWindow window{0, 0, (all.width * 3 + 4) / 5, (all.height * 3 + 4) / 5};
    window.x = static_cast<std::int32_t>(
        uniform_below(bits, static_cast<std::uint32_t>(all.width - window.width + 1)));
    window.y = static_cast<std::int32_t>(
        uniform_below(mix(bits), static_cast<std::uint32_t>(all.height - window.height + 1)));
    return window;
}

}  // namespace

std::uint8_t wang_corners(std::int32_t tile, std::int32_t colors) {
    unsigned corners = 0;
    for (int corner = 0; corner < 4; ++corner, tile /= colors)
        corners |= static_cast<unsigned>(tile % colors) << 2 * corner;
    return static_cast<std::uint8_t>(corners);
}

WangFrames::WangFrames(const PerceptualImage& photo, std::int32_t side, std::int32_t colors,
                       std::uint64_t seed, std::size_t threads, Progress& progress)
    : photo_{photo},
      side_{side},
      colors_{colors},
      seed_{seed},
      half_{side * 3 / 16},
      overlap_{side * 3 / 16} {
    // Of many places for samples those that lie furthest apart
    const std::int32_t sample_side = 2 * (half_ + overlap_);
    const auto across = static_cast<std::uint32_t>(photo.width - sample_side + 1);
    const auto down = static_cast<std::uint32_t>(photo.height - sample_side + 1);
    for (std::int32_t color = 0; color < colors; ++color) {
        PhotoPoint best;
        std::int32_t furthest = -1;
        for (std::int32_t i = 0; i < 16; ++i) {
            const std::uint64_t bits = hash(seed, sample_stream, color, i);
            const PhotoPoint at{static_cast<std::int32_t>(uniform_below(bits, across)),
                                static_cast<std::int32_t>(uniform_below(mix(bits), down))};
            std::int32_t nearest = photo.width + photo.height;
            for (const PhotoPoint other : samples_)
                nearest = std::min(nearest, std::max(std::abs(at.x - other.x), std::abs(at.y - other.y)));
            if (nearest > furthest) furthest = nearest, best = at;
        }
        samples_.push_back(best);
    }
    const auto pairs = static_cast<std::size_t>(colors) * static_cast<std::size_t>(colors);
    strips_.assign(2 * pairs, Canvas{0, 0, false});
    for_each_index(2 * pairs, threads, [&](std::size_t i) {
        if (progress.stop().stop_requested()) return;
        const auto pair = static_cast<std::int32_t>(i % pairs);
        strips_[i] = make_strip(pair / colors_, pair % colors_, i < pairs);
    });
}

Canvas WangFrames::make_strip(std::int32_t from, std::int32_t to, bool across) const {
    // Along the strip the corners lie at 0 and side_, and the edge in its middle
    Canvas canvas{across ? side_ : 2 * half_, across ? 2 * half_ : side_, false};
    const std::int32_t corner = half_ + overlap_;
    for (std::int32_t along = 0; along < corner; ++along)
        for (std::int32_t beside = 0; beside < 2 * half_; ++beside) {
            const auto put = [&](std::int32_t place, PhotoPoint first, std::int32_t inside) {
                const std::int32_t off = overlap_ + beside;
                if (across)
                    canvas.put(place, beside, {first.x + inside, first.y + off}, photo_);
                else
                    canvas.put(beside, place, {first.x + off, first.y + inside}, photo_);
            };
            put(along, sample(from), corner + along);
            put(side_ - corner + along, sample(to), along);
        }
    const std::int32_t length = side_ - 2 * half_;
    const CanvasBlock block =
        across ? CanvasBlock{half_, 0, length, 2 * half_} : CanvasBlock{0, half_, 2 * half_, length};
    lay_cheapest(canvas, photo_, block, best_places(photo_, canvas, block, all_places(photo_, block), 8),
                 across ? BlockRim::left_and_right : BlockRim::top_and_bottom);
    return canvas;
}

const Canvas& WangFrames::strip(std::int32_t from, std::int32_t to, bool across) const {
    return strips_[static_cast<std::size_t>((across ? 0 : colors_ * colors_) + from * colors_ + to)];
}

std::vector<PhotoPoint> WangFrames::make_tile(std::uint8_t corners) const {
    const std::int32_t top_left = color_of(corners, 0), top_right = color_of(corners, 1);
    const std::int32_t bottom_left = color_of(corners, 2), bottom_right = color_of(corners, 3);
    Canvas canvas{side_, side_, false};
    // The halves of the four strips that lie inside; at the corners two show the same sample
    for (std::int32_t along = 0; along < side_; ++along)
        for (std::int32_t beside = 0; beside < half_; ++beside) {
            const auto from = [&](const Canvas& strip, std::int32_t x, std::int32_t y) {
                return strip.sources[strip.index(x, y)];
            };
            const std::int32_t far = side_ - half_ + beside;
            canvas.put(along, beside, from(strip(top_left, top_right, true), along, half_ + beside), photo_);
            canvas.put(along, far, from(strip(bottom_left, bottom_right, true), along, beside), photo_);
            if (along < half_ || along >= side_ - half_) continue;
            canvas.put(beside, along, from(strip(top_left, bottom_left, false), half_ + beside, along),
                       photo_);
            canvas.put(far, along, from(strip(top_right, bottom_right, false), beside, along), photo_);
        }
    const CanvasBlock block{locked - 1, locked - 1, side_ - 2 * (locked - 1), side_ - 2 * (locked - 1)};
    const PlaceWindow window = window_at(all_places(photo_, block), hash(seed_, window_stream, corners, 0));
    // Some cuts more for few tiles, which are seen more often
    const std::size_t cuts = colors_ == 2 ? 6 : colors_ == 3 ? 2 : 1;
    lay_cheapest(canvas, photo_, block, best_places(photo_, canvas, block, window, cuts), BlockRim::all);
    return std::move(canvas.sources);
}

}  // namespace tessera
