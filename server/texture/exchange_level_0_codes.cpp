#include <algorithm>

#include "server/texture/exchange_walk.h"
#include "server/texture/kernels.h"
#include "server/texture/texel_bits.h"

namespace tessera {

/// Rows of level 0 under way, as codes. All is copied: the tile, what shapes show alone and what is known of
/// their blending. Then the few texels where shapes meet that do not always lie side by side are summed.
class ExchangeWalk::Level0Codes {
  public:
    Level0Codes(const ExchangeWalk& walk, const Block& block)
        : texels_{*walk.sources_[0]},
          layout_{walk.layout_},
          codes_{*walk.codes_},
          block_{block},
          blended_{block.width, level_0_rows},
          met_{block.width, level_0_rows},
          summed_{block.width, level_0_rows},
          sums_(std::size_t(block.width) * std::size_t(std::min(block.height, level_0_rows)) * 4 + 64) {}

    void begin(std::int32_t first, std::int32_t count) {
        first_ = first;
        count_ = count;
        // The tile lies under all shapes: to copy all of it is cheaper than to find out where it shows
        for (std::int32_t row = 0; row < count; ++row)
            for_tile(row, 0, block_.width, [&](std::int32_t x, std::int32_t width, const std::uint8_t* tile) {
                copies_.push_back({tile, codes_at(row, x), width});
            });
    }

    /// A joined shape whose box begins at (x, y) of the block.
    std::uint64_t add(const JoinedShapes::Joined& shape, std::int64_t x, std::int64_t y) {
        std::uint64_t texels = 0;
        const std::int64_t from = std::max<std::int64_t>(first_, y);
        const std::int64_t to = std::min<std::int64_t>(first_ + count_, y + shape.height);
        for (std::int64_t at = from; at < to; ++at) {
            const auto row = static_cast<std::int32_t>(at - first_);
            for (const JoinedShapes::Span& span :
                 layout_.joined.row(shape, static_cast<std::int32_t>(at - y))) {
                if (x + span.end <= 0) continue;
                if (x + span.begin >= block_.width) break;
                const auto left = static_cast<std::int32_t>(std::max<std::int64_t>(x + span.begin, 0));
                const auto right =
                    static_cast<std::int32_t>(std::min<std::int64_t>(x + span.end, block_.width));
                texels += static_cast<std::uint64_t>(right - left);
                const std::uint8_t* codes = span.kind == JoinedShapes::Kind::copied
                                                ? texels_.exemplar.code_row(0) + std::size_t{span.from} * 4
                                                : texels_.edges.of(span);
                copies_.push_back({codes + (left - (x + span.begin)) * 4, codes_at(row, left), right - left});
                if (span.kind == JoinedShapes::Kind::open) open({&span, x, row, left, right});
            }
        }
        return texels;
    }

    /// Writes all of them, and is ready for the next band.
    void finish() {
        kernels().copy(copies_.data(), copies_.size());
        copies_.clear();
        for (const Run& run : runs_)
            if (meets_others(run)) sum(run);
        runs_.clear();
        kernels().blend(blends_.data(), blends_.size());
        blends_.clear();
        for (std::int32_t row = 0; row < count_; ++row) {
            for_runs(summed_.row(row), block_.width, [&](std::int32_t left, std::int32_t right) {
                for_tile(row, left, right, [&](std::int32_t x, std::int32_t width, const std::uint8_t* tile) {
                    blended_runs_.push_back({sums(row, x), tile, codes_at(row, x), width});
                });
            });
            for (TexelBits* bits : {&blended_, &met_, &summed_}) bits->clear_row(row);
        }
        kernels().encode_blended(blended_runs_.data(), blended_runs_.size());
        blended_runs_.clear();
    }

  private:
    /// Texels [left, right) of a row that a span lies over; its box begins at x.
    struct Run {
        const JoinedShapes::Span* span;
        std::int64_t x;
        std::int32_t row, left, right;
    };

    std::int32_t* sums(std::int32_t row, std::int32_t x) {
        return sums_.data() + (std::size_t(row) * std::size_t(block_.width) + std::size_t(x)) * 4;
    }
    std::uint8_t* codes_at(std::int32_t row, std::int32_t x) const {
        return codes_.row(block_.out_y + first_ + row) + std::ptrdiff_t(block_.out_x + x) * 4;
    }

    /// Calls `visit(x, width, codes)` for pieces of [left, right) of a row under which the tile does not
    /// wrap.
    template <class Visit>
    void for_tile(std::int32_t row, std::int32_t left, std::int32_t right, const Visit& visit) const {
        const std::int64_t wrap = layout_.tile_side - 1;
        const std::uint8_t* codes =
            texels_.tile.code_row(static_cast<std::int32_t>((block_.y + first_ + row) & wrap));
        while (left < right) {
            const auto u = static_cast<std::int32_t>((block_.x + left) & wrap);
            const std::int32_t width = std::min(right - left, texels_.tile.width() - u);
            visit(left, width, codes + std::ptrdiff_t{u} * 4);
            left += width;
        }
    }

    /// Whether another shape blends there shows later.
    void open(const Run& run) {
        std::uint64_t *blended = blended_.row(run.row), *met = met_.row(run.row);
        TexelBits::for_words(run.left, run.right, [&](std::int32_t word, std::uint64_t bits) {
            met[word] |= blended[word] & bits;
            blended[word] |= bits;
        });
        runs_.push_back(run);
        __builtin_prefetch(layout_.joined.parts(*run.span).data());
    }
    bool meets_others(const Run& run) {
        std::uint64_t others = 0;
        const std::uint64_t* met = met_.row(run.row);
        TexelBits::for_words(run.left, run.right,
                             [&](std::int32_t word, std::uint64_t bits) { others |= met[word] & bits; });
        return others != 0;
    }

    /// weight·(content − tile) of each part, on top of what other shapes add.
    void sum(const Run& run) {
        summed_.set(run.row, run.left, run.right);
        for (const JoinedShapes::Part& part : layout_.joined.parts(*run.span)) {
            const auto left = static_cast<std::int32_t>(std::max<std::int64_t>(run.left, run.x + part.begin));
            const auto right = static_cast<std::int32_t>(std::min<std::int64_t>(run.right, run.x + part.end));
            if (left >= right) continue;
            const auto skipped = static_cast<std::size_t>(left - (run.x + part.begin));
            const std::uint8_t* content =
                texels_.exemplar.code_row(0) + (std::size_t{part.from} + skipped) * 4;
            const std::uint16_t* weights =
                layout_.shapes.weights({part.begin, part.end, part.weights}) + skipped;
            for_tile(run.row, left, right, [&](std::int32_t x, std::int32_t width, const std::uint8_t* tile) {
                blends_.push_back({content + std::ptrdiff_t{x - left} * 4, tile, weights + (x - left),
                                   sums(run.row, x), width});
            });
        }
    }

    const ExchangeTexels& texels_;
    const ExchangeLayout& layout_;
    Rgba8Image& codes_;
    const Block& block_;
    std::int32_t first_ = 0, count_ = 0;
    TexelBits blended_;               ///< By some shape that others may meet.
    TexelBits met_;                   ///< By two and more.
    TexelBits summed_;                ///< Sums are to be added to the tile.
    std::vector<std::int32_t> sums_;  ///< RGBA.
    std::vector<Run> runs_;
    std::vector<Kernels::CopyRun> copies_;
    std::vector<Kernels::BlendRun<std::uint8_t>> blends_;
    std::vector<Kernels::BlendedRun> blended_runs_;
};

Result<Evaluation> ExchangeWalk::blend_codes(const Block& block, const Budget& budget) const {
    UnitGrid shown = layout_.joined_at({0, block.x, block.y, block.width, block.height});
    struct Placed {
        const JoinedShapes::Joined* shape;
        std::int64_t x, y;
    };
    std::vector<Placed> placed;
    for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
        for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux)
            for (const Shown& one : shown.at(ux, uy)) {
                const JoinedShapes::Joined& shape = layout_.joined[one.shape];
                const std::int64_t x = (ux << layout_.unit_level) - block.x +
                                       std::int64_t{one.tile_x} * layout_.tile_side + shape.x;
                const std::int64_t y = (uy << layout_.unit_level) - block.y +
                                       std::int64_t{one.tile_y} * layout_.tile_side + shape.y;
                if (x < block.width && y < block.height && x + shape.width > 0 && y + shape.height > 0)
                    placed.push_back({&shape, x, y});
            }
    Level0Codes band{*this, block};
    std::uint64_t work = 0;
    for (std::int32_t first = 0; first < block.height; first += level_0_rows) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int32_t count = std::min(level_0_rows, block.height - first);
        band.begin(first, count);
        for (const Placed& one : placed)
            if (one.y < first + count && one.y + one.shape->height > first)
                work += band.add(*one.shape, one.x, one.y);
        band.finish();
    }
    return Evaluation{.method = "exemplar", .work = work};
}

}  // namespace tessera
