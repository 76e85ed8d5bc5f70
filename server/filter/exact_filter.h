#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "server/filter/convex_polygon.h"
#include "server/filter/each_footprint.h"

namespace tessera {

/// The area integral of the clipped quadrilateral. Texels that it covers in part count by the covered part of
/// their area (trapezoids, row by row); of those that it covers wholly, whole coarse texels are read where
/// there are many, which the box law makes exact. Cost grows with the footprint's outline, never with its
/// area; where the outline crosses more than `most_outline` texels, its texels are those of a coarser level,
/// and the bound says what that may change.
///
/// A footprint without area is the segment, or point, to which it shrinks: its average is the one along it.
class ExactFilter {
  public:
    static constexpr double most_outline = 32768;

    ExactFilter(const FootprintFilter&, std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : texels_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading);

  private:
    /// Texels of a level, by which the corners of a polygon are counted.
    struct Frame {
        std::int64_t x = 0, y = 0;
        int level = 0;
    };
    /// What each of a row's texels [first, last) has covered, as differences from texel to texel.
    struct Row {
        std::vector<double> steps;
        std::int64_t first = 0, last = 0;
    };

    /// From its upper end to its lower one.
    struct Edge {
        TexelPoint from, to;
        double slope = 0;  ///< Of x along y.
        double sign = 0;   ///< 1 where the polygon lies right of it, −1 where it lies left.
        double at(double y) const noexcept;
    };
    /// A polygon in texels of its frame, and its edges that are not level.
    struct Shape {
        ConvexPolygon polygon;
        Edge edges[12];
        int count = 0;
    };

    void add(const ConvexPolygon& polygon, const Frame& frame, std::size_t depth);
    bool cover_row(const Shape& shape, std::int64_t y, Row& row);
    void add_row(const Shape& shape, const Frame& frame, std::int64_t y, std::size_t depth);
    void add_part(const ConvexPolygon& polygon, const Frame& frame, std::int64_t x, std::int64_t y,
                  std::size_t depth);
    void add_outline_bound(const std::uint16_t* texel, double covered);
    Estimate along_segment(const Footprint& footprint, bool certain);

    PageTables<TexelRows> texels_;
    std::array<Row, 12> rows_;
    Reading* reading_ = nullptr;
    int finest_ = 0;  ///< The level of the texels of the outline.
    Doubles4 sum_;    ///< Steps times texels of the finest level.
    double area_ = 0;
    std::array<double, 4> more_{}, less_{};  ///< What the outline's coarse texels may hide, in texels.
};

}  // namespace tessera
