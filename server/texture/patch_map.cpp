#include "server/texture/patch_map.h"

#include <algorithm>
#include <bit>

namespace tessera {

PatchMap::PatchMap(const ExchangeAsset& asset, std::int32_t radius)
    : side_{asset.tile_side}, radius_{radius} {
    make_weights(asset);
    make_levels();
}

void PatchMap::make_weights(const ExchangeAsset& asset) {
    const std::int32_t side = side_, r = radius_;
    const std::uint32_t window = std::uint32_t(2 * r + 1) * std::uint32_t(2 * r + 1);
    const auto wrapped = [&](std::int32_t a) { return a & (side - 1); };

    // Weights are shares of a window, rounded so that they sum to weight_one: each patch takes the difference
    // between the rounded running totals after and before it
    std::vector<std::uint32_t> total(std::size_t(side) * std::size_t(side));
    const auto rounded = [&](std::uint64_t count) {
        return static_cast<std::uint32_t>((count * weight_one + window / 2) / window);
    };

    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const auto& source = asset.patches[p];
        Patch patch;
        patch.x = wrapped(source.x - r);
        patch.y = wrapped(source.y - r);
        patch.width = source.width + 2 * r;
        patch.height = source.height + 2 * r;

        // How many texels of the patch lie in each texel's window: box sums along rows, then along columns.
        // Only the box counts: the asset's reader has seen to it that it encloses the patch.
        const std::int32_t width = patch.width, height = patch.height;
        const auto at = [&](std::int32_t x, std::int32_t y) {
            return std::size_t(y) * std::size_t(width) + std::size_t(x);
        };
        std::vector<std::uint32_t> mask(std::size_t(width) * std::size_t(height)), rows(mask.size());
        for (std::int32_t y = r; y < height - r; ++y)
            for (std::int32_t x = r; x < width - r; ++x)
                mask[at(x, y)] = asset.labels[std::size_t(wrapped(patch.y + y)) * std::size_t(side) +
                                              std::size_t(wrapped(patch.x + x))] == p;
        for (std::int32_t y = 0; y < height; ++y)
            for (std::int32_t x = 0; x < width; ++x)
                for (std::int32_t dx = std::max(-r, -x); dx <= std::min(r, width - 1 - x); ++dx)
                    rows[at(x, y)] += mask[at(x + dx, y)];

        patch.weights.resize(mask.size());
        for (std::int32_t y = 0; y < height; ++y)
            for (std::int32_t x = 0; x < width; ++x) {
                std::uint32_t count = 0;
                for (std::int32_t dy = std::max(-r, -y); dy <= std::min(r, height - 1 - y); ++dy)
                    count += rows[at(x, y + dy)];
                std::uint32_t& before = total[std::size_t(wrapped(patch.y + y)) * std::size_t(side) +
                                              std::size_t(wrapped(patch.x + x))];
                patch.weights[at(x, y)] =
                    static_cast<std::uint16_t>(rounded(before + count) - rounded(before));
                before += count;
            }
        patches_.push_back(std::move(patch));
    }
}

void PatchMap::make_levels() {
    // Rows of each patch as [begin, end), from its first row on; begin = end where there is nothing
    struct Rows {
        std::int32_t first = 0;
        std::vector<std::pair<std::int32_t, std::int32_t>> spans;
    };
    std::vector<Rows> patches;
    for (const Patch& patch : patches_) {
        Rows rows{patch.y, {}};
        for (std::int32_t y = 0; y < patch.height; ++y) {
            const auto* weights = patch.weights.data() + std::ptrdiff_t(y) * patch.width;
            const auto* end = weights + patch.width;
            const auto* first = std::find_if(weights, end, [](std::uint16_t w) { return w != 0; });
            const auto* last = end;
            while (last > first && last[-1] == 0) --last;
            rows.spans.emplace_back(patch.x + static_cast<std::int32_t>(first - weights),
                                    patch.x + static_cast<std::int32_t>(last - weights));
        }
        patches.push_back(std::move(rows));
    }

    const int tile_level = std::countr_zero(static_cast<std::uint32_t>(side_));
    for (int level = 0; level <= tile_level; ++level) {
        if (level > 0) {
            // OR-reduce: a texel is covered if one of the four below it is
            for (Rows& rows : patches) {
                Rows halved{rows.first >> 1, {}};
                const std::int32_t last = rows.first + std::int32_t(rows.spans.size()) - 1;
                halved.spans.assign(std::size_t((last >> 1) - halved.first + 1), {INT32_MAX, INT32_MIN});
                for (std::size_t i = 0; i < rows.spans.size(); ++i) {
                    const auto [begin, end] = rows.spans[i];
                    if (begin >= end) continue;
                    auto& span =
                        halved.spans[std::size_t(((rows.first + std::int32_t(i)) >> 1) - halved.first)];
                    span.first = std::min(span.first, begin >> 1);
                    span.second = std::max(span.second, ((end - 1) >> 1) + 1);
                }
                rows = std::move(halved);
            }
        }
        Level made;
        made.side = side_ >> level;
        made.stamp_texels.resize(patches.size());
        for (std::int32_t y = 0; y < 2 * made.side; ++y) {
            made.row_begin.push_back(static_cast<std::uint32_t>(made.spans.size()));
            for (std::size_t p = 0; p < patches.size(); ++p) {
                const Rows& rows = patches[p];
                const std::int64_t i = std::int64_t{y} - rows.first;
                if (i < 0 || i >= std::ssize(rows.spans)) continue;
                const auto [begin, end] = rows.spans[std::size_t(i)];
                if (begin >= end) continue;
                made.spans.push_back({begin, end, made.stamp_texels[p], static_cast<std::uint16_t>(p)});
                made.stamp_texels[p] += static_cast<std::uint32_t>(end - begin);
            }
        }
        made.row_begin.push_back(static_cast<std::uint32_t>(made.spans.size()));
        levels_.push_back(std::move(made));
    }
}

std::size_t PatchMap::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const Patch& patch : patches_) bytes += patch.weights.size() * sizeof(std::uint16_t);
    for (const Level& level : levels_)
        bytes += level.row_begin.size() * sizeof(std::uint32_t) + level.spans.size() * sizeof(Span) +
                 level.stamp_texels.size() * sizeof(std::uint32_t);
    return bytes;
}

}  // namespace tessera
