#include "server/filter/line_integral_filter.h"

#include <algorithm>
#include <cmath>

#include "server/filter/lattice.h"

namespace tessera {

namespace {

constexpr double most_lines = 1024;
constexpr double most_pages = 300;
/// Narrower footprints, in texels, are left to the exact filter.
constexpr double least_width = 0x1p-14;

/// What mean_sum() reads: one entry for each end, or one for both inside a texel.
std::uint64_t entries_between(double from, double to) noexcept {
    return static_cast<std::int32_t>(from) == static_cast<std::int32_t>(to) ? 1 : 2;
}

/// The integral between a polygon's edges and the line where places begin: Σ over edges of ∫ S dx (Green).
/// x counts lines, y places, both inside the page.
template <bool Horizontal>
void add_polygon(const ConvexPolygon& polygon, const LineTable<Horizontal>& table, Doubles4& sum,
                 std::uint64_t& texels) {
    for (int k = 0; k < polygon.count; ++k) {
        const TexelPoint& from = polygon.corners[k];
        const TexelPoint& to = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
        if (from.x == to.x || (from.y == 0 && to.y == 0)) continue;
        const bool rightwards = from.x < to.x;
        const TexelPoint a = rightwards ? from : to, b = rightwards ? to : from;
        const double slope = (b.y - a.y) / (b.x - a.x);
        const double low = std::min(a.y, b.y), high = std::max(a.y, b.y);
        auto line = static_cast<std::size_t>(a.x);
        double x = a.x, y = a.y;
        Doubles4 edge;
        for (;; ++line) {
            const auto end = static_cast<double>(line + 1);
            if (end >= b.x) break;
            const double next = std::clamp(a.y + (end - a.x) * slope, low, high);
            edge += table.mean_sum(line, y, next) * (end - x);
            texels += entries_between(y, next);
            x = end;
            y = next;
        }
        edge += table.mean_sum(line, y, b.y) * (b.x - x);
        texels += entries_between(y, b.y);
        sum = rightwards ? sum - edge : sum + edge;
    }
}

}  // namespace

template <bool Horizontal>
Estimate LineIntegralFilter::walk(const Footprint& footprint, int level, Reading& reading,
                                  PageTables<LineTable<Horizontal>>& tables) {
    // Corners in texels of the level, from the corner of the first page; x counts lines
    const FootprintBox box = box_of(footprint);
    const LocalFrame frame{footprint, box, level, level + 8};
    ConvexPolygon polygon;
    polygon.count = 4;
    for (std::size_t k = 0; k < 4; ++k) {
        const TexelPoint p = frame(footprint.corners[k]);
        polygon.corners[k] = Horizontal ? TexelPoint{p.y, p.x} : p;
    }
    const auto& c = polygon.corners;
    const double area = ((c[2].x - c[0].x) * (c[3].y - c[1].y) - (c[2].y - c[0].y) * (c[3].x - c[1].x)) / 2;

    Doubles4 sum;
    const double right = frame.across(box.right), bottom = frame.down(box.bottom);
    constexpr double side = page_side_texels;
    if (right <= side && bottom <= side) {
        add_polygon(polygon, tables.at(level, frame.x, frame.y, reading), sum, reading.texels);
    } else {
        // Page after page, each with the part of the footprint that lies in it
        ConvexPolygon row, rest, part;
        for (std::int64_t j = 0; static_cast<double>(j) * side < bottom; ++j) {
            const double upper = static_cast<double>(j) * side;
            cut<Horizontal, true>(polygon, upper, rest);
            cut<Horizontal, false>(rest, upper + side, row);
            for (std::int64_t i = 0; row.count >= 3 && static_cast<double>(i) * side < right; ++i) {
                const double first = static_cast<double>(i) * side;
                cut<!Horizontal, true>(row, first, rest);
                cut<!Horizontal, false>(rest, first + side, part);
                if (part.count < 3) continue;
                for (int k = 0; k < part.count; ++k) {
                    part.corners[k].x -= Horizontal ? upper : first;
                    part.corners[k].y -= Horizontal ? first : upper;
                }
                add_polygon(part, tables.at(level, frame.x + i, frame.y + j, reading), sum, reading.texels);
            }
        }
    }

    Estimate estimate{sum * (1 / area)};
    if (level > 0) {
        // A texel of the outline of which c is covered may hide c·(1 − c) of itself; an outline crosses at
        // most one texel more than lines and places that it passes, for each side
        const double crossed = 2 * (box.width() + box.height()) * frame.scale + 4;
        estimate.bound_codes = std::min(crossed / 4 / std::fabs(area) * 255, bound_of_any(estimate.steps));
    }
    return estimate;
}

Estimate LineIntegralFilter::operator()(const Footprint& footprint, Reading& reading) {
    const FootprintBox box = box_of(footprint);
    const bool horizontal = filter_.direction == LineDirection::horizontal ||
                            (filter_.direction == LineDirection::best && box.height() < box.width());
    const double lines = horizontal ? box.height() : box.width();
    int level = level_of_at_most(lines, filter_.lines > 0 ? filter_.lines : most_lines);
    const auto pages = [&](int at) {
        const double scale = halved(at + 8);
        return (box.width() * scale + 1) * (box.height() * scale + 1);
    };
    while (level < max_level && pages(level) > most_pages) ++level;

    const double extent = std::max(box.width(), box.height());
    if (!(area_of(footprint) > extent * least_width * static_cast<double>(std::int64_t{1} << level)))
        return exact_(footprint, reading);
    return horizontal ? walk<true>(footprint, level, reading, rows_)
                      : walk<false>(footprint, level, reading, columns_);
}

std::unique_ptr<FootprintSampler> make_line_integral(const FootprintFilter& filter,
                                                     std::shared_ptr<const TexelPages> pages,
                                                     std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<LineIntegralFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
