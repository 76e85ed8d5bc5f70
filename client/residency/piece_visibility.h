#pragma once

#include <vector>

#include "client/residency/plane_view.h"

namespace tessera {

/// Pixels [left, right) × [top, bottom) of the picture.
struct PixelBox {
    int left = 0, top = 0, right = 0, bottom = 0;
    bool is_empty() const { return left >= right || top >= bottom; }
    int pixels() const { return (right - left) * (bottom - top); }
};

/// Which pixels of the picture show which flat piece: of a plane, all up to its horizon; of a surface with
/// more, those where no other piece is nearer, from a depth buffer of its own. Where the GPU's floats might
/// decide otherwise, a pixel shows both.
class PieceVisibility {
  public:
    /// `view` outlives this.
    explicit PieceVisibility(const PlaneView& view);

    /// All pixels that the piece may be in, hidden by others or not.
    PixelBox box_of(const FlatPiece& piece) const;
    /// The same, of a piece of the view: known already.
    const PixelBox& box_known(const FlatPiece& piece) const { return known_of(piece).box; }

    struct Seen {
        int pixels = 0;    ///< That show the piece
        PixelBox box{};    ///< In which they are
        int x = 0, y = 0;  ///< One of them, not far from the middle
    };
    /// `piece`: of the view.
    Seen seen(const FlatPiece& piece, const PixelBox& box) const;

  private:
    /// A side of a piece as a line in the picture: x = slope·y + at, counted from the middle; with a margin
    /// outwards, at + wider.
    struct Line {
        double slope = 0, at = 0, wider = 0;
    };
    struct Lines {
        Line left[5], right[5];
        int lefts = 0, rights = 0;
        struct Level {
            double b = 0, c = 0;  ///< b·y + c ≥ 0
        } level[5];
        int levels = 0;
    };
    Lines lines_of(const FlatPiece& piece) const;
    /// Of the middles of a row's pixels: [first, end) on the piece's side of all lines; and a margin more.
    struct Span {
        int first = 0, end = 0;
    };
    void row_spans(const Lines& lines, double y, const PixelBox& box, Span& exact, Span& wide) const;

    /// The pixels of a row that show a piece: from the first to the last, and how many of these do.
    struct Row {
        int left = 0, right = 0, pixels = 0;
    };
    struct Known {
        PixelBox box{};
        std::size_t first_row = 0;  ///< In rows_
    };
    void add_to_nearest(const FlatPiece& piece);
    void find_rows(const FlatPiece& piece, const Known& known);
    Row shown_in(const FlatPiece& piece, int y, int first, int end) const;
    const Known& known_of(const FlatPiece& piece) const {
        return known_[static_cast<std::size_t>(&piece - view_.pieces().data())];
    }

    const PlaneView& view_;
    std::vector<Known> known_;    ///< By the view's pieces
    std::vector<Row> rows_;       ///< Of each piece's box, one after the other; empty for a plane
    std::vector<float> nearest_;  ///< w of each pixel's nearest piece; empty for a plane
};

}  // namespace tessera
