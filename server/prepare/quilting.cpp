#include "server/prepare/quilting.h"

#include <algorithm>
#include <atomic>

#include "server/prepare/canvas.h"
#include "server/prepare/parallel.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// How blocks are laid: `count` a row, one every `step` texels, each `side` = step + overlap wide.
struct Layout {
    std::int32_t step = 0, overlap = 0, side = 0, count = 0;
};

/// Blocks as large as the photograph gives room to choose among, so that large features stay whole.
Layout layout_of(const PerceptualImage& photo, std::int32_t side) {
    const std::int32_t room = std::min(photo.width, photo.height);
    Layout layout;
    layout.step = side / 2;
    while (layout.step > 8 && layout.step + layout.step * 3 / 8 > room * 5 / 8) layout.step /= 2;
    layout.overlap = std::max(4, layout.step * 3 / 8);
    layout.side = layout.step + layout.overlap;
    layout.count = side / layout.step;
    return layout;
}

/// One tile, begun with the photograph's block at `first`.
QuiltedTile quilt_from(const PerceptualImage& photo, std::int32_t side, const Layout& layout,
                       PhotoPoint first, const Progress& progress) {
    Canvas canvas{side, side, true};
    for (std::int32_t row = 0; row < layout.count; ++row)
        for (std::int32_t column = 0; column < layout.count; ++column) {
            if (progress.stop().stop_requested()) return {};
            const CanvasBlock block{column * layout.step, row * layout.step, layout.side, layout.side};
            const bool is_first = row == 0 && column == 0;
            lay_block(canvas, photo, block,
                      is_first ? first : best_places(photo, canvas, block, all_places(photo, block), 1)[0],
                      BlockRim::all);
        }
    return {side, std::move(canvas.sources), {side, side, std::move(canvas.colors)}, canvas.seam_cost};
}

}  // namespace

QuiltedTile quilt_tile(const PerceptualImage& photo, std::int32_t side, std::uint64_t seed,
                       std::size_t threads, Progress& progress) {
    constexpr std::uint64_t beginnings_stream = stream("quilting");
    constexpr std::size_t most_beginnings = 8;
    const Layout layout = layout_of(photo, side);
    // Large tiles of many blocks have good and bad cuts whatever they begin with
    const auto blocks = static_cast<std::size_t>(layout.count) * static_cast<std::size_t>(layout.count);
    const std::size_t beginnings = std::clamp<std::size_t>(4 * most_beginnings / blocks, 1, most_beginnings);

    std::vector<QuiltedTile> quilts(beginnings);
    std::atomic<std::size_t> done{0};
    for_each_index(beginnings, threads, [&](std::size_t i) {
        const std::uint64_t bits = hash(seed, beginnings_stream, static_cast<std::int64_t>(i), 0);
        const auto across = static_cast<std::uint32_t>(photo.width - layout.side + 1);
        const auto down = static_cast<std::uint32_t>(photo.height - layout.side + 1);
        const PhotoPoint first{static_cast<std::int32_t>(uniform_below(bits, across)),
                               static_cast<std::int32_t>(uniform_below(mix(bits), down))};
        quilts[i] = quilt_from(photo, side, layout, first, progress);
        progress.advance("tile", static_cast<double>(++done) / static_cast<double>(beginnings));
    });
    if (progress.stop().stop_requested()) return {};
    const auto cheaper = [](const QuiltedTile& a, const QuiltedTile& b) { return a.seam_cost < b.seam_cost; };
    return std::move(*std::min_element(quilts.begin(), quilts.end(), cheaper));
}

}  // namespace tessera
