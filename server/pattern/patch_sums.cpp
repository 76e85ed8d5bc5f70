#include "server/pattern/patch_sums.h"

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

/// Maps of more patches keep sums of blocks of patches.
constexpr std::int64_t most_single_sums = std::int64_t{1} << 20;
constexpr int most_block_log2 = 3;

int block_log2(const StoredMap& map) noexcept {
    const std::int64_t width = patch_axis(map, map.width).count, height = patch_axis(map, map.height).count;
    if (width * height <= most_single_sums) return 0;
    if (map.edge != StoredMap::Edge::wrap) return most_block_log2;
    return std::min(most_block_log2, std::countr_zero(static_cast<std::uint64_t>(width | height)));
}
std::int64_t offset_of(std::int64_t at, const StoredMap& map) noexcept {
    return (at >> map.cells_log2) & ((std::int64_t{1} << block_log2(map)) - 1);
}

}  // namespace

std::int64_t PatchSums::count(const StoredMap& map) noexcept {
    return (patch_axis(map, map.width).count * patch_axis(map, map.height).count) >> 2 * block_log2(map);
}

PatchSums::PatchSums(const StoredMap& map, const PatchMean& patch_mean)
    : block_{block_log2(map)},
      shift_x_{offset_of(map.x, map)},
      shift_y_{offset_of(map.y, map)},
      sums_{make(map, patch_mean)} {}

AreaSums PatchSums::make(const StoredMap& map, const PatchMean& patch_mean) const {
    const AreaSums::Axis x = patch_axis(map, map.width), y = patch_axis(map, map.height);
    const auto blocks = [&](const AreaSums::Axis& axis, std::int64_t shift) -> AreaSums::Axis {
        if (axis.wraps) return {0, axis.count >> block_, true};
        const std::int64_t from = ((axis.from + shift) >> block_) - 1;
        return {from, ((axis.from + axis.count + shift - 1) >> block_) + 2 - from, false};
    };
    return AreaSums{blocks(x, shift_x_), blocks(y, shift_y_), [&](std::int64_t i, std::int64_t j) {
                        Colour sum{};
                        for (std::int64_t row = (j << block_) - shift_y_;
                             row < ((j + 1) << block_) - shift_y_; ++row)
                            for (std::int64_t column = (i << block_) - shift_x_;
                                 column < ((i + 1) << block_) - shift_x_; ++column) {
                                const Colour mean = patch_mean(column, row);
                                for (std::size_t c = 0; c < 4; ++c) sum[c] += mean[c];
                            }
                        return sum;
                    }};
}

}  // namespace tessera
