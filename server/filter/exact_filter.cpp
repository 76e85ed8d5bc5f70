#include "server/filter/exact_filter.h"

#include <algorithm>
#include <cmath>

#include "server/filter/lattice.h"

namespace tessera {

namespace {

/// Levels from a texel to the texels that its covered part is made of.
constexpr int descent = 5;
/// A footprint of more texels than that, and that many times its outline, begins with coarser ones.
constexpr double most_area = 8192, most_of_outline = 16;
/// Thinner than that, relative to its length, a footprint's area is lost in rounding.
constexpr double thinnest = 0x1p-36;

/// Adds an edge's part inside one row, from (x, ·) to (to_x, ·), `height` high, to what lies right of it.
void add_edge(double x, double to_x, double height, double* steps) noexcept {
    const double low = std::min(x, to_x), high = std::max(x, to_x);
    const std::int64_t first = floor_of(low);
    double* at = steps + first;
    if (high <= static_cast<double>(first + 1)) {
        const double left = (low + high) / 2 - static_cast<double>(first);
        at[0] += height * (1 - left);
        at[1] += height * left;
        return;
    }
    const double slope = height / (high - low);
    double before = 0, right = static_cast<double>(first + 1) - low;
    double covered = slope * right * right / 2;
    for (std::int64_t i = first + 1;; ++i) {
        *at++ += covered - before;
        before = covered;
        const double beyond = high - static_cast<double>(i);
        if (beyond <= 1) {
            covered = height - slope * beyond * beyond / 2;
            break;
        }
        covered = slope * (right + 0.5);
        right += 1;
    }
    at[0] += covered - before;
    at[1] += height - covered;
}

}  // namespace

double ExactFilter::Edge::at(double y) const noexcept {
    if (y == to.y) return to.x;
    return std::clamp(from.x + (y - from.y) * slope, std::min(from.x, to.x), std::max(from.x, to.x));
}

void ExactFilter::add(const ConvexPolygon& polygon, const Frame& frame, std::size_t depth) {
    Shape shape;
    shape.polygon = polygon;
    double top = polygon.corners[0].y, bottom = top, right = polygon.corners[0].x;
    for (int k = 0; k < polygon.count; ++k) {
        const TexelPoint a = polygon.corners[k], b = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
        top = std::min(top, a.y);
        bottom = std::max(bottom, a.y);
        right = std::max(right, a.x);
        if (a.y == b.y) continue;
        const bool down = b.y > a.y;
        shape.edges[shape.count++] = {down ? a : b, down ? b : a, (b.x - a.x) / (b.y - a.y),
                                      down ? -1.0 : 1.0};
    }
    Row& row = rows_[depth];
    const auto wide = static_cast<std::size_t>(right) + 3;
    if (row.steps.size() < wide) row.steps.resize(wide);
    const auto last = static_cast<std::int64_t>(std::ceil(bottom));
    for (std::int64_t y = floor_of(top); y < last; ++y)
        if (cover_row(shape, y, row)) add_row(shape, frame, y, depth);
}

bool ExactFilter::cover_row(const Shape& shape, std::int64_t y, Row& row) {
    const auto upper = static_cast<double>(y), lower = upper + 1;
    double left = 1e300, right = 0;
    struct Part {
        double from, to, height;
    } parts[12];
    int count = 0;
    for (int k = 0; k < shape.count; ++k) {
        const Edge& edge = shape.edges[k];
        const double from = std::max(edge.from.y, upper), to = std::min(edge.to.y, lower);
        if (!(to > from)) continue;
        const double x0 = edge.at(from), x1 = edge.at(to);
        parts[count++] = {x0, x1, edge.sign * (to - from)};
        left = std::min({left, x0, x1});
        right = std::max({right, x0, x1});
    }
    if (count == 0) return false;
    row.first = floor_of(left);
    row.last = static_cast<std::int64_t>(std::ceil(right));
    std::fill(row.steps.begin() + row.first, row.steps.begin() + row.last + 2, 0.0);
    for (int k = 0; k < count; ++k) add_edge(parts[k].from, parts[k].to, parts[k].height, row.steps.data());
    return true;
}

void ExactFilter::add_row(const Shape& shape, const Frame& frame, std::int64_t y, std::size_t depth) {
    const Row& row = rows_[depth];
    const double* steps = row.steps.data();
    const auto weight = static_cast<double>(std::uint64_t{1} << 2 * (frame.level - finest_));
    const bool outline = frame.level == finest_;
    double covered = 0;
    for (std::int64_t x = row.first; x < row.last;) {
        // A page's texels
        const std::int64_t page_x = (frame.x + x) >> 8, page_y = (frame.y + y) >> 8;
        const std::int64_t end = std::min(row.last, ((page_x + 1) << 8) - frame.x);
        const std::uint16_t* texel = texels_.at(frame.level, page_x, page_y, *reading_)
                                         .texel((frame.x + x) & 255, (frame.y + y) & 255);
        __builtin_prefetch(texel + std::ptrdiff_t{16} * 4 * page_side_texels);
        while (x < end) {
            covered += steps[x];
            const bool whole = covered > 1 - 1e-9;
            if (covered <= 0) {
                ++x;
                texel += 4;
                continue;
            }
            if (!outline && !whole) {
                add_part(shape.polygon, frame, x, y, depth);
                ++x;
                break;  // The page may have been replaced meanwhile
            }
            // All that have as much covered are one sum
            const std::int64_t from = x;
            Ints4 sum = load_steps(texel);
            if (finest_ > 0 && !whole) add_outline_bound(texel, covered);
            for (++x, texel += 4; x < end && steps[x] == 0; ++x, texel += 4) {
                sum += load_steps(texel);
                if (finest_ > 0 && !whole) add_outline_bound(texel, covered);
            }
            const double part = covered * weight;
            sum_ += Doubles4{sum} * part;
            area_ += part * static_cast<double>(x - from);
            reading_->texels += static_cast<std::uint64_t>(x - from);
        }
    }
}

void ExactFilter::add_part(const ConvexPolygon& polygon, const Frame& frame, std::int64_t x, std::int64_t y,
                           std::size_t depth) {
    ConvexPolygon a, b;
    cut<true, true>(polygon, static_cast<double>(x), a);
    cut<true, false>(a, static_cast<double>(x + 1), b);
    cut<false, true>(b, static_cast<double>(y), a);
    cut<false, false>(a, static_cast<double>(y + 1), b);
    if (b.count < 3) return;
    const int levels = std::min(descent, frame.level - finest_);
    const double scale = static_cast<double>(1 << levels);
    for (int k = 0; k < b.count; ++k)
        b.corners[k] = {(b.corners[k].x - static_cast<double>(x)) * scale,
                        (b.corners[k].y - static_cast<double>(y)) * scale};
    add(b, {(frame.x + x) * (1 << levels), (frame.y + y) * (1 << levels), frame.level - levels}, depth + 1);
}

void ExactFilter::add_outline_bound(const std::uint16_t* texel, double covered) {
    // A texel of mean m, of which c is covered: the covered part's sum is between max(0, c + m − 1) and
    // min(c, m), and is taken for c·m
    const double c = std::min(covered, 1.0);
    for (std::size_t k = 0; k < 4; ++k) {
        const double m = texel[k] / 65535.0;
        more_[k] += std::min(c * (1 - m), m * (1 - c));
        less_[k] += std::min(c * m, (1 - c) * (1 - m));
    }
}

Estimate ExactFilter::along_segment(const Footprint& footprint, bool certain) {
    // The two corners that are furthest from each other
    TexelPoint from = footprint.corners[0], to = from;
    double furthest = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = i + 1; k < 4; ++k) {
            const TexelPoint a = footprint.corners[i], b = footprint.corners[k];
            const double square = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
            if (square <= furthest) continue;
            furthest = square;
            from = a;
            to = b;
        }
    const double reach = std::fabs(to.x - from.x) + std::fabs(to.y - from.y);
    const int level = level_of_at_most(reach, most_outline);
    const double scale = halved(level);
    const LatticePoint base = lattice_point(footprint, from);
    const std::int64_t mask = (std::int64_t{1} << level) - 1;
    const TexelPoint start{(static_cast<double>(base.x & mask) + base.in_x) * scale,
                           (static_cast<double>(base.y & mask) + base.in_y) * scale};
    const TexelPoint way{(to.x - from.x) * scale, (to.y - from.y) * scale};

    // From crossing to crossing with the lines between texels
    const auto crossing = [](double at, double by, double line) { return by == 0 ? 2.0 : (line - at) / by; };
    double next_x = way.x < 0 ? std::ceil(start.x) - 1 : std::floor(start.x) + 1;
    double next_y = way.y < 0 ? std::ceil(start.y) - 1 : std::floor(start.y) + 1;
    for (double at = 0; at < 1;) {
        const double until_x = crossing(start.x, way.x, next_x), until_y = crossing(start.y, way.y, next_y);
        const double until = std::min({until_x, until_y, 1.0});
        const double middle = reach > 0 ? (at + until) / 2 : 0;
        const std::int64_t x = (base.x >> level) + floor_of(start.x + middle * way.x),
                           y = (base.y >> level) + floor_of(start.y + middle * way.y);
        const std::uint16_t* texel = texels_.at(level, x >> 8, y >> 8, *reading_).texel(x & 255, y & 255);
        const double share = std::max(until - at, 0.0);
        sum_ += Doubles4{load_steps(texel)} * share;
        area_ += share;
        ++reading_->texels;
        at = std::max(at, until);
        if (until_x <= until) next_x += way.x < 0 ? -1 : 1;
        if (until_y <= until) next_y += way.y < 0 ? -1 : 1;
    }
    Estimate estimate{sum_ * (1 / area_)};
    if (!certain || level > 0) estimate.bound_codes = bound_of_any(estimate.steps);
    return estimate;
}

Estimate ExactFilter::operator()(const Footprint& footprint, Reading& reading) {
    reading_ = &reading;
    sum_ = {};
    area_ = 0;
    more_ = {};
    less_ = {};
    const FootprintBox box = box_of(footprint);
    const double extent = std::max(box.width(), box.height());
    const double area = area_of(footprint);
    if (!(area > extent * extent * thinnest)) return along_segment(footprint, area == 0);

    // The finest level by the outline, the coarsest by the area
    finest_ = level_of_at_most(2 * (box.width() + box.height()), most_outline);
    int level = finest_;
    double texels = area * halved(2 * level), outline = 2 * (box.width() + box.height()) * halved(level);
    for (; texels > std::max(most_area, outline * most_of_outline) && level < max_level; ++level) {
        texels /= 4;
        outline /= 2;
    }

    const LocalFrame frame{footprint, box, level, level};
    ConvexPolygon polygon;
    polygon.count = 4;
    for (std::size_t k = 0; k < 4; ++k) polygon.corners[k] = frame(footprint.corners[k]);
    const auto cross = [&](int a, int b) {
        const TexelPoint p = polygon.corners[a], q = polygon.corners[b], o = polygon.corners[0];
        return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
    };
    if (cross(1, 2) + cross(2, 3) < 0) std::swap(polygon.corners[1], polygon.corners[3]);
    add(polygon, {frame.x, frame.y, level}, 0);
    if (!(area_ > 0)) return along_segment(footprint, false);

    Estimate estimate{sum_ * (1 / area_)};
    // Rounding of corners against the width of the footprint, then what coarse texels hide
    double bound = 0x1p-46 * (extent + 2) * extent / area;
    if (finest_ > 0)
        for (std::size_t k = 0; k < 4; ++k) bound = std::max(bound, std::max(more_[k], less_[k]) / area_);
    estimate.bound_codes = std::min(bound * 255, bound_of_any(estimate.steps));
    return estimate;
}

std::unique_ptr<FootprintSampler> make_exact(const FootprintFilter& filter,
                                             std::shared_ptr<const TexelPages> pages,
                                             std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<ExactFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
