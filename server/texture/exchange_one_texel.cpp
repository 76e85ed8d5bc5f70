#include <algorithm>
#include <array>
#include <span>

#include "server/texture/exchange_walk.h"
#include "shared/math/srgb.h"

namespace tessera {

/// What a ray or a picker asks for: nothing is allocated, and only what lies over the texel is looked at.
Result<Evaluation> ExchangeWalk::one_texel(const Block& block, const Budget& budget) const {
    if (auto spent = check_budget(budget); !spent) return spent.error();
    const ExchangeTexels& source = *sources_[0];
    const std::int64_t wrap = layout_.tile_side - 1;
    const std::uint8_t* tile =
        source.tile.code_row(static_cast<std::int32_t>(block.y & wrap)) + std::ptrdiff_t(block.x & wrap) * 4;
    std::uint8_t* out = codes_->row(block.out_y) + std::ptrdiff_t{block.out_x} * 4;
    std::int32_t sums[3] = {};
    std::uint64_t blended = 0;
    /// A shape whose box lies over the texel: its row, the texel's column in it, and what it shows there.
    struct Candidate {
        std::span<const Shapes::Segment> row;
        std::int32_t x;
        const std::uint8_t* codes;
    };
    std::array<Candidate, 4> candidates;
    std::size_t found = 0;
    const auto show = [&](const Candidate& candidate) {
        const auto [row, x, codes] = candidate;
        for (const Shapes::Segment& segment : row) {
            if (x >= segment.end) continue;
            if (x < segment.begin) break;
            if (segment.weights == Shapes::Segment::all_one) {
                std::copy_n(codes, 4, out);
                return true;
            }
            const std::int32_t weight = layout_.shapes.weights(segment)[x - segment.begin];
            for (std::int32_t c = 0; c < 3; ++c)
                sums[c] +=
                    weight * (std::int32_t{srgb_to_steps[codes[c]]} - std::int32_t{srgb_to_steps[tile[c]]});
            ++blended;
            break;
        }
        return false;
    };
    const auto show_all = [&] {
        const bool shown = std::any_of(candidates.begin(), candidates.begin() + found, show);
        found = 0;
        return shown;
    };

    // The units whose shapes may reach the texel: its own, and those before it that hang over
    const std::int64_t x = (block.x - layout_.overhang) >> layout_.unit_level;
    const std::int64_t y = (block.y - layout_.overhang) >> layout_.unit_level;
    const std::int64_t last_x = block.x >> layout_.unit_level, last_y = block.y >> layout_.unit_level;
    const TypedQuadtree::Square types =
        layout_.tree->square_at(x, y, static_cast<int>(last_x - x), static_cast<int>(last_y - y));
    for (std::int64_t uy = y; uy <= last_y; ++uy)
        for (std::int64_t ux = x; ux <= last_x; ++ux) {
            const std::int64_t in_x = block.x - (ux << layout_.unit_level);
            const std::int64_t in_y = block.y - (uy << layout_.unit_level);
            for (const Shown& one :
                 layout_.rows_of(layout_.variants.of(types.at[std::size_t(uy - y)][std::size_t(ux - x)]),
                                 in_y, in_y + 1)) {
                const Shapes::Box& box = layout_.shapes.box(one.shape);
                const std::int64_t column = in_x - std::int64_t{one.tile_x} * layout_.tile_side - box.x;
                const std::int64_t row = in_y - std::int64_t{one.tile_y} * layout_.tile_side - box.y;
                if (column < 0 || row < 0 || column >= box.width || row >= box.height) continue;
                const auto u = static_cast<std::int32_t>(column), v = static_cast<std::int32_t>(row);
                const Shapes::Shape& shape = layout_.shapes[one.shape];
                Candidate& candidate = candidates[found++];
                candidate = {
                    layout_.shapes.row(shape, v), u,
                    source.exemplar.code_row(shape.from_y + v) + std::ptrdiff_t{shape.from_x + u} * 4};
                __builtin_prefetch(candidate.codes);
                __builtin_prefetch(candidate.row.data());
                if (found == candidates.size() && show_all())
                    return Evaluation{.method = "exemplar", .work = 1};
            }
        }
    if (show_all()) return Evaluation{.method = "exemplar", .work = 1};
    constexpr auto one = static_cast<std::int32_t>(Shapes::weight_one);
    std::copy_n(tile, 4, out);
    if (blended > 0)
        for (std::int32_t c = 0; c < 3; ++c) {
            // Never negative, but as unsigned numbers they have room
            const std::uint32_t step =
                static_cast<std::uint32_t>(srgb_to_steps[tile[c]]) * Shapes::weight_one +
                static_cast<std::uint32_t>(sums[c]) + one / 2;
            out[c] = steps_to_srgb()[step / Shapes::weight_one];
        }
    return Evaluation{.method = "exemplar", .work = blended};
}

}  // namespace tessera
