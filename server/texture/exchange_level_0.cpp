#include <algorithm>
#include <cstring>

#include "server/texture/exchange_texture.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Rows that are blended together: few enough that their sums stay in a near cache.
constexpr std::int32_t band_rows = 16;

}  // namespace

/// Rows of level 0 under way: what is copied stands in the output already, what is blended is summed until
/// all shapes have been added. Integers, so that their order does not matter.
class CompiledExchange::Level0Band {
  public:
    Level0Band(const CompiledExchange& texture, const Block& block, const Rows& rows)
        : texture_{texture},
          block_{block},
          rows_{rows},
          sums_(std::size_t(block.width) * std::size_t(std::min(block.height, band_rows)) * 4 + 64),
          blended_(std::size_t(block.width) * std::size_t(std::min(block.height, band_rows))) {}

    /// Begins with the tile everywhere.
    void begin(std::int32_t first, std::int32_t count) {
        first_ = first;
        count_ = count;
        for (std::int32_t row = first; row < first + count; ++row)
            tile_runs(row, 0, block_.width,
                      [&](std::int32_t x, std::int32_t width, std::int32_t u, std::int32_t v) {
                          copy(texture_.tile_, u, v, width, row, x);
                      });
    }

    /// A shape whose box begins at (x, y) of the block.
    std::uint64_t add(const Shapes::Shape& shape, std::int64_t x, std::int64_t y) {
        const Shapes& shapes = texture_.layout_->shapes;
        std::uint64_t texels = 0;
        const std::int64_t from = std::max<std::int64_t>(first_, y);
        const std::int64_t to = std::min<std::int64_t>(first_ + count_, y + shape.height);
        for (std::int64_t at = from; at < to; ++at) {
            const auto row = static_cast<std::int32_t>(at), line = static_cast<std::int32_t>(at - y);
            const auto segments = shapes.row(shape, line);
            if (!segments.empty())
                prefetch(shape.from_x + segments.front().begin, shape.from_y + line + prefetch_rows,
                         segments.back().end - segments.front().begin);
            for (const Shapes::Segment& segment : segments) {
                const auto left = static_cast<std::int32_t>(std::max<std::int64_t>(x + segment.begin, 0));
                const auto right =
                    static_cast<std::int32_t>(std::min<std::int64_t>(x + segment.end, block_.width));
                if (left >= right) continue;
                const auto in_box = static_cast<std::int32_t>(left - x);
                const std::int32_t u = shape.from_x + in_box, v = shape.from_y + line;
                texels += static_cast<std::uint64_t>(right - left);
                if (segment.weights == Shapes::Segment::all_one)
                    copy(texture_.exemplar_, u, v, right - left, row, left);
                else
                    blend(shapes.weights(segment) + (in_box - segment.begin), u, v, row, left, right);
            }
        }
        return texels;
    }

    /// Writes what was blended, and is ready for the next band.
    void finish() {
        for (std::int32_t row = first_; row < first_ + count_; ++row) {
            std::uint8_t* const line = blended_.data() + index(row, 0);
            std::uint8_t* const line_end = line + block_.width;
            const auto find = [&](std::uint8_t* from, int value) {
                void* found = std::memchr(from, value, static_cast<std::size_t>(line_end - from));
                return found == nullptr ? line_end : static_cast<std::uint8_t*>(found);
            };
            for (std::uint8_t* at = find(line, 1); at != line_end;) {
                std::uint8_t* const end = find(at, 0);
                const auto left = static_cast<std::int32_t>(at - line),
                           right = static_cast<std::int32_t>(end - line);
                tile_runs(row, left, right,
                          [&](std::int32_t x, std::int32_t width, std::int32_t u, std::int32_t v) {
                              put_blended(row, x, width, u, v);
                          });
                std::fill(at, end, std::uint8_t{0});
                std::fill_n(sums_.begin() + static_cast<std::ptrdiff_t>(index(row, left) * 4),
                            (right - left) * 4, 0);
                at = find(end, 1);
            }
        }
    }

  private:
    std::size_t index(std::int32_t row, std::int32_t x) const {
        return std::size_t(row - first_) * std::size_t(block_.width) + std::size_t(x);
    }
    std::uint8_t* codes_at(std::int32_t row, std::int32_t x) const {
        return rows_.codes->row(block_.out_y + row) + std::ptrdiff_t(block_.out_x + x) * 4;
    }
    float* linear_at(std::int32_t row, std::int32_t x) const {
        return rows_.linear->row(block_.out_y + row) + std::ptrdiff_t(block_.out_x + x) * 4;
    }

    /// Calls `visit(x, width, u, v)` for pieces of [left, right) of a row that begin at the tile's texel (u,
    /// v) and do not wrap.
    template <class Visit>
    void tile_runs(std::int32_t row, std::int32_t left, std::int32_t right, const Visit& visit) const {
        const std::int64_t wrap = texture_.layout_->tile_side - 1;
        const auto v = static_cast<std::int32_t>((block_.y + row) & wrap);
        while (left < right) {
            const auto u = static_cast<std::int32_t>((block_.x + left) & wrap);
            const std::int32_t width = std::min(right - left, texture_.tile_.width() - u);
            visit(left, width, u, v);
            left += width;
        }
    }

    /// Rows of a box are far apart in the exemplar: no processor guesses where the next one lies.
    static constexpr std::int32_t prefetch_rows = 3;
    void prefetch(std::int32_t u, std::int32_t v, std::int32_t width) const {
        if (!texture_.exemplar_.has_codes() || v >= texture_.exemplar_.height()) return;
        const std::uint8_t* texels = texture_.exemplar_.code_row(v) + std::ptrdiff_t{u} * 4;
        for (std::int32_t i = 0; i < width * 4 + 63; i += 64) __builtin_prefetch(texels + i);
    }

    void copy(const TexelSource& source, std::int32_t u, std::int32_t v, std::int32_t width, std::int32_t row,
              std::int32_t x) const {
        if (rows_.codes != nullptr) {
            std::copy_n(source.code_row(v) + std::ptrdiff_t{u} * 4, width * 4, codes_at(row, x));
            return;
        }
        float* out = linear_at(row, x);
        for (std::int32_t i = 0; i < width; ++i, out += 4) {
            for (std::int32_t c = 0; c < 3; ++c)
                out[c] = linear(std::uint32_t{source.step(u + i, v, c)} * Shapes::weight_one);
            out[3] = 1.0F;
        }
    }

    /// weight·(content − tile) on top of what other shapes have added.
    void blend(const std::uint16_t* weights, std::int32_t u, std::int32_t v, std::int32_t row,
               std::int32_t left, std::int32_t right) {
        const TexelSource &exemplar = texture_.exemplar_, &tile = texture_.tile_;
        std::fill_n(blended_.begin() + static_cast<std::ptrdiff_t>(index(row, left)), right - left,
                    std::uint8_t{1});
        tile_runs(row, left, right,
                  [&](std::int32_t x, std::int32_t width, std::int32_t tile_u, std::int32_t tile_v) {
                      std::int32_t* sums = sums_.data() + index(row, x) * 4;
                      const std::int32_t from = u + x - left;
                      const std::uint16_t* weight = weights + (x - left);
                      if (tile.has_codes()) {
                          kernels().blend(exemplar.code_row(v) + std::ptrdiff_t{from} * 4,
                                          tile.code_row(tile_v) + std::ptrdiff_t{tile_u} * 4, weight, width,
                                          sums);
                          return;
                      }
                      for (std::int32_t i = 0; i < width; ++i)
                          for (std::int32_t c = 0; c < 3; ++c)
                              sums[i * 4 + c] += weight[i] * (std::int32_t{exemplar.step(from + i, v, c)} -
                                                              std::int32_t{tile.step(tile_u + i, tile_v, c)});
                  });
    }

    void put_blended(std::int32_t row, std::int32_t x, std::int32_t width, std::int32_t u,
                     std::int32_t v) const {
        const std::int32_t* sums = sums_.data() + index(row, x) * 4;
        const TexelSource& tile = texture_.tile_;
        if (rows_.codes != nullptr) {
            kernels().encode_blended(sums, tile.code_row(v) + std::ptrdiff_t{u} * 4, width, codes_at(row, x));
            return;
        }
        float* out = linear_at(row, x);
        for (std::int32_t i = 0; i < width; ++i, out += 4) {
            for (std::int32_t c = 0; c < 3; ++c)
                out[c] = linear(std::uint32_t{tile.step(u + i, v, c)} * Shapes::weight_one +
                                static_cast<std::uint32_t>(sums[i * 4 + c]));
            out[3] = 1.0F;
        }
    }

    static float linear(std::uint32_t weighted_steps) {
        return static_cast<float>(weighted_steps) / (linear_one * Shapes::weight_one);
    }

    const CompiledExchange& texture_;
    const Block& block_;
    const Rows& rows_;
    std::int32_t first_ = 0, count_ = 0;
    std::vector<std::int32_t> sums_;     ///< RGBA
    std::vector<std::uint8_t> blended_;  ///< 1 where sums are to be added to the tile.
};

Result<Evaluation> CompiledExchange::blend_texels(const Block& block, const Budget& budget,
                                                  const Rows& rows) const {
    const ExchangeLayout& layout = *layout_;
    UnitGrid shown = shown_in(block);
    Level0Band band{*this, block, rows};
    std::uint64_t work = 0;
    for (std::int32_t first = 0; first < block.height; first += band_rows) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int32_t count = std::min(band_rows, block.height - first);
        band.begin(first, count);
        for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
            for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux) {
                const std::int64_t unit_x = (ux << layout.unit_level) - block.x;
                const std::int64_t unit_y = (uy << layout.unit_level) - block.y;
                for (const Shown& one :
                     layout.rows_of(shown.at(ux, uy), first - unit_y, first + count - unit_y)) {
                    const std::int64_t tile_x = unit_x + std::int64_t{one.tile_x} * layout.tile_side;
                    const Shapes::Box& box = layout.shapes.box(one.shape);
                    const std::int64_t y = unit_y + std::int64_t{one.tile_y} * layout.tile_side + box.y;
                    if (y >= first + count || y + box.height <= first) continue;
                    const std::int64_t x = tile_x + box.x;
                    if (x >= block.width || x + box.width <= 0) continue;
                    work += band.add(layout.shapes[one.shape], x, y);
                }
            }
        band.finish();
    }
    return Evaluation{.method = "exemplar", .work = work};
}

Result<std::vector<std::uint32_t>> CompiledExchange::sources(const TexelRegion& region) const {
    if (region.level != 0) return Error{ErrorCode::invalid_input, "only level 0 shows one source a texel"};
    const ExchangeLayout& layout = *layout_;
    const Block block{0, region.x, region.y, region.width, region.height, 0, 0};
    UnitGrid shown = shown_in(block);
    std::vector<std::uint32_t> out(std::size_t(region.width) * std::size_t(region.height));
    for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
        for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux)
            for (const Shown& one : shown.at(ux, uy)) {
                const Shapes::Shape& shape = layout.shapes[one.shape];
                const std::int64_t x = (ux << layout.unit_level) - block.x +
                                       std::int64_t{one.tile_x} * layout.tile_side + shape.x;
                const std::int64_t y = (uy << layout.unit_level) - block.y +
                                       std::int64_t{one.tile_y} * layout.tile_side + shape.y;
                for (std::int64_t row = std::max<std::int64_t>(y, 0);
                     row < std::min<std::int64_t>(y + shape.height, region.height); ++row)
                    for (const Shapes::Segment& segment :
                         layout.shapes.row(shape, static_cast<std::int32_t>(row - y))) {
                        for (std::int32_t column = segment.begin; column < segment.end; ++column) {
                            const bool most = segment.weights == Shapes::Segment::all_one ||
                                              layout.shapes.weights(segment)[column - segment.begin] >
                                                  Shapes::weight_one / 2;
                            if (most && x + column >= 0 && x + column < region.width)
                                out[std::size_t(row) * std::size_t(region.width) + std::size_t(x + column)] =
                                    1u + one.shape;
                        }
                    }
            }
    return out;
}

}  // namespace tessera
