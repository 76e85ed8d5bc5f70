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

    struct Seen {
        int pixels = 0;    ///< That show the piece
        PixelBox box{};    ///< In which they are
        int x = 0, y = 0;  ///< One of them, not far from the middle
    };
    Seen seen(const FlatPiece& piece, const PixelBox& box) const;

  private:
    /// A side of a piece as a line in the picture: a·x + b·y + c ≥ 0 on the piece's side, in pixels from it.
    struct Line {
        double a = 0, b = 0, c = 0;
    };
    struct Lines {
        Line lines[5];
        int count = 0;
    };
    Lines lines_of(const FlatPiece& piece) const;
    /// Of the middles of a row's pixels: [first, end) on the piece's side of all lines, but for a margin.
    void row_span(const Lines& lines, double y, double margin, int& first, int& end) const;

    const Lines& lines_known(const FlatPiece& piece) const;

    const PlaneView& view_;
    mutable const FlatPiece* known_ = nullptr;  ///< Of which `lines_` are: the last that was asked for
    mutable Lines lines_;
    std::vector<float> nearest_;  ///< w of each pixel's nearest piece; empty for a plane
};

}  // namespace tessera
