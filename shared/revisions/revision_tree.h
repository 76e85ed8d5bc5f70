#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include <boost/smart_ptr/intrusive_ptr.hpp>

#include "shared/revisions/dirty_rects.h"
#include "shared/revisions/page_revisions.h"

namespace tessera::detail {

/// Places are unsigned: texels from (−2^39, −2^39), so that cells of up to 2^40 hold all pages and gutters.
inline constexpr std::int64_t origin = std::int64_t{1} << 39;
inline constexpr std::uint8_t plane_log2 = 40;

/// A box of places, both ends included.
struct PlaceBox {
    std::uint64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    bool meets(const PlaceBox& other) const noexcept {
        return x0 <= other.x1 && other.x0 <= x1 && y0 <= other.y1 && other.y0 <= y1;
    }
    bool contains(const PlaceBox& other) const noexcept {
        return x0 <= other.x0 && y0 <= other.y0 && other.x1 <= x1 && other.y1 <= y1;
    }
};

/// A dyadic square: its corner is a multiple of its side.
struct Cell {
    std::uint64_t x = 0, y = 0;
    std::uint8_t log2 = 0;
    bool operator==(const Cell&) const = default;

    PlaceBox box() const noexcept {
        const std::uint64_t last = (std::uint64_t{1} << log2) - 1;
        return {x, y, x + last, y + last};
    }
    bool contains(const Cell& other) const noexcept {
        return other.log2 <= log2 && (x ^ other.x) >> log2 == 0 && (y ^ other.y) >> log2 == 0;
    }
    /// Which quarter of this larger cell holds a place.
    std::size_t quarter(std::uint64_t px, std::uint64_t py) const noexcept {
        return (py >> (log2 - 1) & 1) * 2 + (px >> (log2 - 1) & 1);
    }
};

struct RevisionNode;
using RevisionNodePtr = boost::intrusive_ptr<RevisionNode>;

/// A cell with some rectangles in it, and up to four smaller cells in its quarters.
/// There is no node that has neither rectangles nor at least two children.
struct RevisionNode {
    mutable std::atomic<std::uint32_t> references{0};
    Cell cell;
    std::uint64_t weight = 0;  ///< Bytes of it and all under it.
    Revision newest = 0;       ///< Of it and all under it.
    DirtyRects rects;
    std::array<RevisionNodePtr, 4> children;

    bool leaf() const noexcept;
    /// Weight and newest from the parts.
    void sum_up() noexcept;
};

DirtyRect rect_in(const Cell& cell, const PlaceBox& box, Revision revision) noexcept;
PlaceBox box_of(const Cell& cell, const DirtyRect& rect) noexcept;

/// Boxes go to cells of a page of level 0 or larger ones; where these are crowded, to smaller ones still,
/// since gutters see what lies in which part of the page next to theirs.
inline constexpr std::uint8_t page_cell_log2 = 8, smallest_cell_log2 = 5;

/// Adds what `revision` touched: `box`, in up to four cells of two to four times its side, none larger than
/// `within`, which holds it. Where a cell is crowded, its oldest goes to smaller cells, at most `pushes`
/// times.
void insert(RevisionNodePtr& link, const Cell& within, const PlaceBox& box, Revision revision, int& pushes);

/// The newest of `best` and what meets `box`. `visits` left; without any, what may meet it counts as well.
void find_newest(const RevisionNode& node, const PlaceBox& box, Revision& best, int& visits) noexcept;

/// Goes along the cells whose children are all leaves, in the order of their last places (Z order).
struct JoiningHand {
    std::uint64_t x = 0, y = 0;      ///< The last place that was passed.
    std::uint8_t joined_log2 = 0;    ///< Cells up to this size are joined.
    std::uint8_t passed_log2 = 255;  ///< The smallest cell that was passed since the start.
    int visits = 0;                  ///< Of nodes, that are left.
};

/// The next cell to join behind the hand, which goes there; nothing at the end, or when there are no visits
/// left.
std::optional<Cell> next_to_join(const RevisionNode& node, JoiningHand& hand);

/// Joins the leaves under `cell` into it.
void join(RevisionNodePtr& link, const Cell& cell);

}  // namespace tessera::detail
