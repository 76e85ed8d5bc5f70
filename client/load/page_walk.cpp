#include "client/load/page_walk.h"

#include <algorithm>

#include "shared/math/hash.h"

namespace tessera {
namespace {

/// Uniform in [0, 2^log2_count).
std::uint32_t uniform_power(std::uint64_t bits, unsigned log2_count) {
    return log2_count == 0 ? 0 : static_cast<std::uint32_t>(bits >> (64 - log2_count));
}

}  // namespace

RandomWalk::RandomWalk(Extent extent, std::vector<LevelWeight> levels, std::uint64_t seed,
                       std::size_t working_set)
    : extent_{extent}, levels_{std::move(levels)}, seed_{seed} {
    for (const LevelWeight& level : levels_) sum_of_weights_ += level.weight;
    set_.reserve(working_set);
    for (std::size_t i = 0; i < working_set; ++i) set_.push_back(draw(stream("working set"), i));
}

PageKey RandomWalk::draw(std::uint64_t stream_key, std::uint64_t counter) const {
    const auto bits = [&](std::int64_t what) {
        return hash(seed_, stream_key, static_cast<std::int64_t>(counter), what);
    };
    std::uint32_t share = uniform_below(bits(0), sum_of_weights_);
    std::size_t i = 0;
    while (share >= levels_[i].weight) share -= levels_[i++].weight;
    const std::uint8_t level = levels_[i].level;
    const unsigned log2_side = extent_.zoom(level);
    return {level, uniform_power(bits(1), log2_side), uniform_power(bits(2), log2_side)};
}

PageKey RandomWalk::next() {
    const std::uint64_t counter = drawn_++;
    if (set_.empty()) return draw(stream("walk"), counter);
    const auto count = static_cast<std::uint32_t>(set_.size());
    return set_[uniform_below(hash(seed_, stream("walk"), static_cast<std::int64_t>(counter), 0), count)];
}

SweepWalk::SweepWalk(Extent extent, std::vector<LevelWeight> levels, std::uint64_t seed, std::uint32_t side)
    : extent_{extent}, levels_{std::move(levels)}, side_{std::max(1u, side)} {
    const unsigned log2_side = extent_.zoom(levels_.front().level);
    place_x_ = uniform_power(hash(seed, stream("place"), 0, 0), log2_side);
    place_y_ = uniform_power(hash(seed, stream("place"), 0, 1), log2_side);
    start_level();
}

void SweepWalk::start_level() {
    const std::uint8_t level = levels_[level_index_].level;
    const unsigned coarser = level - levels_.front().level;
    const std::uint32_t pages = extent_.side_pages(level);
    width_ = std::min(side_, pages);
    const auto corner = [&](std::uint64_t place) {
        // The middle of the square stays where it is, as far as the extent's edge allows
        const std::uint64_t middle = (place + side_ / 2) >> coarser;
        const std::uint64_t from = middle > width_ / 2 ? middle - width_ / 2 : 0;
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(from, pages - width_));
    };
    left_ = corner(place_x_);
    top_ = corner(place_y_);
    column_ = row_ = 0;
}

PageKey SweepWalk::next() {
    const std::uint32_t across = row_ % 2 == 0 ? column_ : width_ - 1 - column_;
    const PageKey page{levels_[level_index_].level, left_ + across, top_ + row_};
    if (++column_ == width_) {
        column_ = 0;
        ++row_;
    }
    if (row_ == width_) {
        if (++level_index_ == levels_.size()) {
            level_index_ = 0;
            const std::uint64_t pages = extent_.side_pages(levels_.front().level);
            place_x_ += side_;
            if (place_x_ >= pages) {
                place_x_ = 0;
                place_y_ = place_y_ + side_ < pages ? place_y_ + side_ : 0;
            }
        }
        start_level();
    }
    return page;
}

}  // namespace tessera
