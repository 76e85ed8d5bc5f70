#include "shared/revisions/dirty_rects.h"

#include <algorithm>

namespace tessera::detail {
namespace {

DirtyRect hull(const DirtyRect& a, const DirtyRect& b) noexcept {
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1),
            std::max(a.revision, b.revision)};
}

/// One less than the area: a whole cell has 2^64.
std::uint64_t area(const DirtyRect& rect) noexcept {
    const std::uint64_t width = std::uint64_t{rect.x1} - rect.x0 + 1,
                        height = std::uint64_t{rect.y1} - rect.y0 + 1;
    return width * height - 1;
}

/// What `over`, which is newer, leaves of `rect`, if that is a rectangle again, else `rect`.
DirtyRect trimmed(DirtyRect rect, const DirtyRect& over) noexcept {
    if (over.x0 <= rect.x0 && rect.x1 <= over.x1) {
        if (over.y0 <= rect.y0 && rect.y0 <= over.y1 && over.y1 < rect.y1) rect.y0 = over.y1 + 1;
        if (over.y1 >= rect.y1 && rect.y1 >= over.y0 && over.y0 > rect.y0) rect.y1 = over.y0 - 1;
    } else if (over.y0 <= rect.y0 && rect.y1 <= over.y1) {
        if (over.x0 <= rect.x0 && rect.x0 <= over.x1 && over.x1 < rect.x1) rect.x0 = over.x1 + 1;
        if (over.x1 >= rect.x1 && rect.x1 >= over.x0 && over.x0 > rect.x0) rect.x1 = over.x0 - 1;
    }
    return rect;
}

/// The area that joining the two makes newer than it is.
std::uint64_t cost_of_joining(const DirtyRect& a, const DirtyRect& b) noexcept {
    const std::uint64_t whole = area(hull(a, b));
    if (a.revision != b.revision) return whole - area(a.revision > b.revision ? a : b);
    // Of one revision: what neither covers, at least
    const std::uint64_t both = area(a) + area(b) + 1;
    return both < area(a) || both >= whole ? 0 : whole - both;
}

}  // namespace

void DirtyRects::add(DirtyRect rect) {
    if (!trim(rect)) return;
    remove_under(rect);
    rects_.push_back(rect);
}

bool DirtyRects::trim(DirtyRect& rect) const noexcept {
    for (const DirtyRect& other : rects_) {
        if (other.revision >= rect.revision && other.contains(rect)) return false;
        if (other.revision > rect.revision) rect = trimmed(rect, other);
    }
    return true;
}

DirtyRect DirtyRects::take_oldest() {
    const auto oldest =
        std::min_element(rects_.begin(), rects_.end(),
                         [](const DirtyRect& a, const DirtyRect& b) { return a.revision < b.revision; });
    const DirtyRect rect = *oldest;
    rects_.erase(oldest);
    return rect;
}

void DirtyRects::remove_under(const DirtyRect& rect) {
    std::erase_if(rects_, [&](const DirtyRect& other) {
        return other.revision <= rect.revision && rect.contains(other);
    });
    for (DirtyRect& other : rects_) {
        if (other.revision <= rect.revision) other = trimmed(other, rect);
    }
}

void DirtyRects::join_two() {
    std::size_t first = 0, second = 1;
    std::uint64_t least = ~std::uint64_t{0};
    for (std::size_t a = 0; a < rects_.size(); ++a) {
        for (std::size_t b = a + 1; b < rects_.size(); ++b) {
            const std::uint64_t cost = cost_of_joining(rects_[a], rects_[b]);
            if (cost >= least) continue;
            least = cost;
            first = a;
            second = b;
        }
    }
    const DirtyRect joined = hull(rects_[first], rects_[second]);
    rects_.erase(rects_.begin() + static_cast<std::ptrdiff_t>(second));
    rects_.erase(rects_.begin() + static_cast<std::ptrdiff_t>(first));
    remove_under(joined);
    rects_.push_back(joined);
}

}  // namespace tessera::detail
