#pragma once

#include <array>
#include <optional>
#include <vector>

#include "client/residency/plane_view.h"

namespace tessera {

/// Boxes of the plane, found by a point in them: a tree of halves.
class BoxTree {
  public:
    struct Box {
        double left = 0, top = 0, right = 0, bottom = 0;
        bool has(double x, double y) const { return x >= left && x <= right && y >= top && y <= bottom; }
    };
    explicit BoxTree(std::vector<Box> boxes);

    /// Calls `found` with the index of each box that has the point.
    template <class Found>
    void each_at(double x, double y, const Found& found) const {
        visit(1, 0, order_.size(), x, y, found);
    }

  private:
    static constexpr std::size_t most_in_leaf = 8;
    void build(std::size_t node, std::size_t first, std::size_t end);

    template <class Found>
    void visit(std::size_t node, std::size_t first, std::size_t end, double x, double y,
               const Found& found) const {
        if (first == end || !around_[node].has(x, y)) return;
        if (end - first <= most_in_leaf) {
            for (std::size_t i = first; i < end; ++i)
                if (boxes_[order_[i]].has(x, y)) found(order_[i]);
            return;
        }
        const std::size_t middle = (first + end) / 2;
        visit(2 * node, first, middle, x, y, found);
        visit(2 * node + 1, middle, end, x, y, found);
    }

    std::vector<Box> boxes_;
    std::vector<std::size_t> order_;
    std::vector<Box> around_;  ///< Of each node; its halves are 2n and 2n + 1, the root is 1.
};

/// A box around what may be seen of the texture, from the clip centre; nowhere: its left is right of its
/// right.
BoxTree::Box texels_of(const PlaneView& view);

/// A surface's flat pieces as a picture shows them, from the texture's side: where in the picture a texel is
/// seen. The same rows lead there as lead back (FlatPiece), so that both agree to a double's rounding.
class PicturePieces {
  public:
    /// `view` is of no plane.
    explicit PicturePieces(const PlaneView& view);

    /// A corridor shows each texel on all of its four sides, since the texture is folded into it: one sheet
    /// each, floor, east, ceiling, west. Everything else has one.
    static int sheets(const Surface& surface) { return surface.kind == Surface::Kind::corridor ? 4 : 1; }

    struct Pixel {
        double x = 0, y = 0;
    };
    /// Where a texel, counted from the clip centre, is seen. Nothing where the sheet does not have it, where
    /// something nearer hides it, where it faces away, behind the eye, and more than a little beside the
    /// picture.
    std::optional<Pixel> pixel_of(double x, double y, int sheet) const;

  private:
    bool is_hidden(const Pixel& pixel, double w) const;

    PlaneView view_;
    std::vector<int> sheets_;  ///< Of each piece
    std::optional<BoxTree> by_texel_, by_pixel_;
};

}  // namespace tessera
