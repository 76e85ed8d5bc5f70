#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/texture/exchange_asset.h"

namespace tessera {

/// The shapes of all contents that may be shown, with their blending: what weight each has at every texel of
/// level 0. A shape stands for one content; its number counts the contents that are not dropped, patch by
/// patch.
///
/// A weight is the share of the shape in the (2·radius + 1)² texels around, rounded down; the tile has the
/// rest. Shapes that are shown together are disjoint, so that weights sum to one everywhere and none is
/// negative.
class Shapes {
  public:
    static constexpr std::uint32_t weight_one = 32768;

    /// A run of texels of one row whose weights are all one, or all less.
    struct Segment {
        std::uint16_t begin = 0, end = 0;  ///< Columns relative to the shape's box.
        std::uint32_t weights = all_one;   ///< Of the first texel in weights().
        static constexpr std::uint32_t all_one = ~std::uint32_t{0};
    };
    struct Shape {
        std::uint32_t patch = 0, content = 0;  ///< In the asset.
        /// The box, grown by the radius: its first texel is in [0, side) for content exchange, in [−radius,
        /// side − radius) else, so that of all tiles the shape is counted to the first that it meets.
        std::int32_t x = 0, y = 0;
        std::int32_t width = 0, height = 0;
        std::int32_t from_x = 0, from_y = 0;  ///< The exemplar's texel on the box's first one.
        std::uint32_t first_row = 0;          ///< Of height + 1 entries in row_begin.
    };

    /// `radius`: half the blending width in texels; 0 cuts hard.
    Shapes(const ExchangeAsset& asset, std::int32_t radius);

    std::size_t size() const noexcept { return shapes_.size(); }
    const Shape& operator[](std::size_t shape) const noexcept { return shapes_[shape]; }
    /// The same box, small enough that all of them stay in the fastest cache.
    struct Box {
        std::int16_t x = 0, y = 0, width = 0, height = 0;
    };
    const Box& box(std::size_t shape) const noexcept { return boxes_[shape]; }
    /// The segments of a row, from left to right, of all texels with a weight.
    std::span<const Segment> row(const Shape& shape, std::int32_t y) const noexcept {
        const std::uint32_t* begin = row_begin_.data() + shape.first_row + y;
        return {segments_.data() + begin[0], segments_.data() + begin[1]};
    }
    const std::uint16_t* weights(const Segment& segment) const noexcept {
        return weights_.data() + segment.weights;
    }
    std::size_t weight_count() const noexcept { return weights_.size(); }  ///< And room behind.
    /// Shapes of a patch: [first_of(p), first_of(p + 1)).
    std::uint32_t first_of(std::size_t patch) const noexcept { return first_of_[patch]; }
    std::size_t patch_count() const noexcept { return first_of_.size() - 1; }
    std::int32_t radius() const noexcept { return radius_; }
    std::int32_t widest() const noexcept { return widest_; }  ///< Width of the widest box.
    std::size_t memory_bytes() const noexcept;

  private:
    void add(const BitMask& mask, Shape shape);

    std::int32_t radius_;
    std::int32_t widest_ = 0;
    std::vector<Shape> shapes_;
    std::vector<Box> boxes_;
    std::vector<std::uint32_t> first_of_;
    std::vector<std::uint32_t> row_begin_;
    std::vector<Segment> segments_;
    std::vector<std::uint16_t> weights_;
};

}  // namespace tessera
