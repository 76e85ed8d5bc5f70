#include "server/prepare/interchange_sets.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "shared/math/hash.h"

namespace tessera {
namespace {

using Set = ExchangeAsset::Set;

bool overlap(const InterchangePatch& a, const InterchangePatch& b, std::int32_t b_x, std::int32_t b_y) {
    const std::int32_t left = std::max(a.x, b_x), right = std::min(a.x + a.width, b_x + b.width);
    const std::int32_t top = std::max(a.y, b_y), bottom = std::min(a.y + a.height, b_y + b.height);
    for (std::int32_t y = top; y < bottom; ++y)
        for (std::int32_t x = left; x < right; ++x)
            if (a.shape.at(x - a.x, y - a.y) && b.shape.at(x - b_x, y - b_y)) return true;
    return false;
}

}  // namespace

bool overlap_on_neighbours(const InterchangePatch& a, const InterchangePatch& b, std::int32_t tile_side) {
    return overlap(a, b, b.x - tile_side, b.y) || overlap(a, b, b.x + tile_side, b.y) ||
           overlap(a, b, b.x, b.y - tile_side) || overlap(a, b, b.x, b.y + tile_side);
}

std::vector<Set> divide_into_sets(const std::vector<InterchangePatch>& patches, std::int32_t tile_side,
                                  std::uint64_t seed) {
    constexpr std::uint64_t order_stream = stream("pseudo-biclique");
    std::vector<std::size_t> order(patches.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t p) { return hash(seed, order_stream, static_cast<std::int64_t>(p), 0); };
    std::sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) { return key(p) < key(q); });

    std::vector<Set> sets(patches.size(), Set::none);
    std::vector<std::size_t> a, b;
    const auto fits = [&](std::size_t p, const std::vector<std::size_t>& others) {
        return std::none_of(others.begin(), others.end(), [&](std::size_t other) {
            return overlap_on_neighbours(patches[p], patches[other], tile_side);
        });
    };
    for (const std::size_t p : order) {
        if (!patches[p].in_rhombus) continue;
        const bool a_first = a.size() <= b.size();
        for (const bool to_a : {a_first, !a_first}) {
            if (!fits(p, to_a ? b : a)) continue;
            (to_a ? a : b).push_back(p);
            sets[p] = to_a ? Set::a : Set::b;
            break;
        }
    }
    return sets;
}

}  // namespace tessera
