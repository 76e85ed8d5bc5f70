#pragma once

#include <cstdint>
#include <vector>

#include "shared/revisions/revision.h"

namespace tessera::detail {

/// A rectangle inside a cell and the revision that touched it; both ends belong to it. In texels from the
/// cell's corner, or in units of 2^(cell_log2 − 32) where the cell is larger.
struct DirtyRect {
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    Revision revision = 0;

    bool operator==(const DirtyRect&) const = default;
    bool contains(const DirtyRect& other) const noexcept {
        return x0 <= other.x0 && y0 <= other.y0 && other.x1 <= x1 && other.y1 <= y1;
    }
};

/// The rectangles of one cell: at every texel the newest revision that was added there.
class DirtyRects {
  public:
    static constexpr std::size_t max_rects = 4;

    void add(DirtyRect rect);
    /// Takes away what lies under `rect`, which is kept elsewhere.
    void remove_under(const DirtyRect& rect);

    /// More than there should be: then one of these.
    bool crowded() const noexcept { return rects_.size() > max_rects; }
    /// Joins the two that make the least area newer than it is.
    void join_two();
    /// Takes away the oldest.
    DirtyRect take_oldest();
    /// What the newer ones here leave of `rect`, roughly; `rect` is under one of them where this is nothing.
    bool trim(DirtyRect& rect) const noexcept;

    /// One of those that rects() gave before, in their order.
    void restore(const DirtyRect& rect) { rects_.push_back(rect); }

    const std::vector<DirtyRect>& rects() const noexcept { return rects_; }
    bool empty() const noexcept { return rects_.empty(); }

  private:
    std::vector<DirtyRect> rects_;
};

}  // namespace tessera::detail
