#include <algorithm>

#include "server/texture/exchange_walk.h"
#include "server/texture/kernels.h"
#include "server/texture/texel_bits.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Of a step or, in steps times weight_one, of blended ones, which are no more than 65535.
void put_linear(float* rgb, std::int32_t red, std::int32_t green, std::int32_t blue, float one) {
    rgb[0] = static_cast<float>(red) / one;
    rgb[1] = static_cast<float>(green) / one;
    rgb[2] = static_cast<float>(blue) / one;
}

}  // namespace

/// Rows of level 0 under way: what is copied stands in the output already, what is blended is summed until
/// all shapes have been added. Integers, so that their order does not matter.
class ExchangeWalk::Level0Sums {
  public:
    Level0Sums(const ExchangeWalk& walk, const Block& block)
        : walk_{walk},
          block_{block},
          rows_{std::min(block.height, level_0_rows)},
          covered_{block.width, rows_},
          summed_{block.width, rows_},
          sums_(walk.sources_.size() * texels() * 4 + 64),
          linear_{walk.codes_ == nullptr ? walk.sources_.size() : 0, block.width, rows_} {}

    void begin(std::int32_t first, std::int32_t count) {
        first_ = first;
        count_ = count;
    }

    /// A shape whose box begins at (x, y) of the block.
    std::uint64_t add(const Shapes::Shape& shape, std::int64_t x, std::int64_t y) {
        const Shapes& shapes = walk_.layout_.shapes;
        std::uint64_t texels = 0;
        const std::int64_t from = std::max<std::int64_t>(first_, y);
        const std::int64_t to = std::min<std::int64_t>(first_ + count_, y + shape.height);
        for (std::int64_t at = from; at < to; ++at) {
            const auto row = static_cast<std::int32_t>(at - first_), line = static_cast<std::int32_t>(at - y);
            for (const Shapes::Segment& segment : shapes.row(shape, line)) {
                if (x + segment.begin >= block_.width) break;
                const auto left = static_cast<std::int32_t>(std::max<std::int64_t>(x + segment.begin, 0));
                const auto right =
                    static_cast<std::int32_t>(std::min<std::int64_t>(x + segment.end, block_.width));
                if (left >= right) continue;
                const auto in_box = static_cast<std::int32_t>(left - x);
                const std::int32_t u = shape.from_x + in_box, v = shape.from_y + line;
                texels += static_cast<std::uint64_t>(right - left);
                covered_.set(row, left, right);
                if (segment.weights == Shapes::Segment::all_one)
                    copy(&ExchangeTexels::exemplar, u, v, right - left, row, left);
                else
                    sum({&segment, in_box - segment.begin, u, v, row, left, right});
            }
        }
        return texels;
    }

    /// Writes what was blended, and the tile where no shape is, and is ready for the next band.
    void finish() {
        kernels().blend(code_runs_.data(), code_runs_.size());
        kernels().blend_steps(step_runs_.data(), step_runs_.size());
        code_runs_.clear();
        step_runs_.clear();
        for (std::int32_t row = 0; row < count_; ++row) {
            for_runs(summed_.row(row), block_.width, [&](std::int32_t left, std::int32_t right) {
                tile_runs(row, left, right,
                          [&](std::int32_t x, std::int32_t width, std::int32_t u, std::int32_t v) {
                              put_blended(row, x, width, u, v);
                          });
            });
            copy_uncovered(row);
            for (TexelBits* bits : {&covered_, &summed_}) bits->clear_row(row);
        }
        walk_.put(block_, first_, count_, linear_);
    }

  private:
    /// Texels [left, right) of a row that show the exemplar from (u, v) on, with these weights.
    struct Run {
        const Shapes::Segment* segment;
        std::int32_t in_segment;  ///< Where in it the run begins.
        std::int32_t u, v, row, left, right;
    };

    std::size_t texels() const { return std::size_t(block_.width) * std::size_t(rows_); }
    std::int32_t* sums(std::size_t source, std::int32_t row, std::int32_t x) {
        return sums_.data() +
               (source * texels() + std::size_t(row) * std::size_t(block_.width) + std::size_t(x)) * 4;
    }

    /// Calls `visit(x, width, u, v)` for pieces of [left, right) of a row that begin at the tile's texel (u,
    /// v) and do not wrap.
    template <class Visit>
    void tile_runs(std::int32_t row, std::int32_t left, std::int32_t right, const Visit& visit) const {
        const std::int64_t wrap = walk_.layout_.tile_side - 1;
        const auto v = static_cast<std::int32_t>((block_.y + first_ + row) & wrap);
        const std::int32_t tile_width = walk_.sources_[0]->tile.width();
        while (left < right) {
            const auto u = static_cast<std::int32_t>((block_.x + left) & wrap);
            const std::int32_t width = std::min(right - left, tile_width - u);
            visit(left, width, u, v);
            left += width;
        }
    }

    void copy_tile(std::int32_t row, std::int32_t left, std::int32_t right) {
        tile_runs(row, left, right, [&](std::int32_t x, std::int32_t width, std::int32_t u, std::int32_t v) {
            copy(&ExchangeTexels::tile, u, v, width, row, x);
        });
    }
    /// The tile where no shape is.
    void copy_uncovered(std::int32_t row) {
        std::uint64_t* const covered = covered_.row(row);
        for (std::size_t i = 0; i < covered_.words(); ++i) covered[i] = ~covered[i];
        for_runs(covered, block_.width,
                 [&](std::int32_t left, std::int32_t right) { copy_tile(row, left, right); });
    }

    void copy(TexelSource ExchangeTexels::*image, std::int32_t u, std::int32_t v, std::int32_t width,
              std::int32_t row, std::int32_t x) {
        for (std::size_t s = 0; s < walk_.sources_.size(); ++s) {
            const TexelSource& from = walk_.sources_[s]->*image;
            float* rgb = linear_.row(s, row) + std::ptrdiff_t{x} * 3;
            if (!from.has_codes()) {
                const std::uint16_t* steps = from.step_row(v) + std::ptrdiff_t{u} * 4;
                for (std::int32_t i = 0; i < width; ++i, rgb += 3, steps += 4)
                    put_linear(rgb, steps[0], steps[1], steps[2], linear_one);
                continue;
            }
            for (std::int32_t i = 0; i < width; ++i, rgb += 3)
                put_linear(rgb, from.step(u + i, v, 0), from.step(u + i, v, 1), from.step(u + i, v, 2),
                           linear_one);
        }
    }

    /// weight·(content − tile) on top of what other shapes add.
    void sum(const Run& run) {
        // The tile's rows go on as far as the widest box: a run never wraps
        const std::int64_t wrap = walk_.layout_.tile_side - 1;
        const auto tile_u = static_cast<std::int32_t>((block_.x + run.left) & wrap);
        const auto tile_v = static_cast<std::int32_t>((block_.y + first_ + run.row) & wrap);
        const std::int32_t width = run.right - run.left;
        const std::uint16_t* weights = walk_.layout_.shapes.weights(*run.segment) + run.in_segment;
        summed_.set(run.row, run.left, run.right);
        for (std::size_t s = 0; s < walk_.sources_.size(); ++s) {
            const TexelSource &exemplar = walk_.sources_[s]->exemplar, &tile = walk_.sources_[s]->tile;
            if (tile.has_codes())
                code_runs_.push_back({exemplar.code_row(run.v) + std::ptrdiff_t{run.u} * 4,
                                      tile.code_row(tile_v) + std::ptrdiff_t{tile_u} * 4, weights,
                                      sums(s, run.row, run.left), width});
            else
                step_runs_.push_back({exemplar.step_row(run.v) + std::ptrdiff_t{run.u} * 4,
                                      tile.step_row(tile_v) + std::ptrdiff_t{tile_u} * 4, weights,
                                      sums(s, run.row, run.left), width});
        }
    }

    void put_blended(std::int32_t row, std::int32_t x, std::int32_t width, std::int32_t u, std::int32_t v) {
        for (std::size_t s = 0; s < walk_.sources_.size(); ++s) {
            const TexelSource& tile = walk_.sources_[s]->tile;
            std::int32_t* sum = sums(s, row, x);
            float* rgb = linear_.row(s, row) + std::ptrdiff_t{x} * 3;
            constexpr auto one = static_cast<std::int32_t>(Shapes::weight_one);
            for (std::int32_t i = 0; i < width; ++i, rgb += 3, sum += 4) {
                put_linear(rgb, tile.step(u + i, v, 0) * one + sum[0], tile.step(u + i, v, 1) * one + sum[1],
                           tile.step(u + i, v, 2) * one + sum[2], linear_one * Shapes::weight_one);
                std::fill_n(sum, 4, 0);
            }
        }
    }

    const ExchangeWalk& walk_;
    const Block& block_;
    const std::int32_t rows_;
    std::int32_t first_ = 0, count_ = 0;
    TexelBits covered_;               ///< By some shape.
    TexelBits summed_;                ///< Sums are to be added to the tile.
    std::vector<std::int32_t> sums_;  ///< Of each source, RGBA.
    std::vector<Kernels::BlendRun<std::uint8_t>> code_runs_;
    std::vector<Kernels::BlendRun<std::uint16_t>> step_runs_;
    SumRows linear_;
};

Result<Evaluation> ExchangeWalk::blend_linear(const Block& block, const Budget& budget) const {
    UnitGrid shown = layout_.shown_at({0, block.x, block.y, block.width, block.height});
    Level0Sums band{*this, block};
    std::uint64_t work = 0;
    for (std::int32_t first = 0; first < block.height; first += level_0_rows) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int32_t count = std::min(level_0_rows, block.height - first);
        band.begin(first, count);
        for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
            for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux) {
                const std::int64_t unit_x = (ux << layout_.unit_level) - block.x;
                const std::int64_t unit_y = (uy << layout_.unit_level) - block.y;
                for (const Shown& one :
                     layout_.rows_of(shown.at(ux, uy), first - unit_y, first + count - unit_y)) {
                    const std::int64_t tile_x = unit_x + std::int64_t{one.tile_x} * layout_.tile_side;
                    const Shapes::Box& box = layout_.shapes.box(one.shape);
                    const std::int64_t y = unit_y + std::int64_t{one.tile_y} * layout_.tile_side + box.y;
                    if (y >= first + count || y + box.height <= first) continue;
                    const std::int64_t x = tile_x + box.x;
                    if (x >= block.width || x + box.width <= 0) continue;
                    work += band.add(layout_.shapes[one.shape], x, y);
                }
            }
        band.finish();
    }
    return Evaluation{.method = "exemplar", .work = work};
}

}  // namespace tessera
