#pragma once

#include "shared/math/footprint.h"

namespace tessera {

/// Convex: four corners, cut by up to eight lines.
struct ConvexPolygon {
    TexelPoint corners[12];
    int count = 0;
};

/// Keeps what lies beyond the line y = at (`Vertical`: x = at), or before it (Sutherland and Hodgman, 1974).
template <bool Vertical, bool Above>
void cut(const ConvexPolygon& in, double at, ConvexPolygon& out) noexcept {
    out.count = 0;
    for (int k = 0; k < in.count; ++k) {
        const TexelPoint a = in.corners[k], b = in.corners[k + 1 == in.count ? 0 : k + 1];
        const double from = Vertical ? a.x : a.y, to = Vertical ? b.x : b.y;
        const bool a_in = Above ? from >= at : from <= at, b_in = Above ? to >= at : to <= at;
        if (a_in) out.corners[out.count++] = a;
        if (a_in != b_in) {
            const double share = (at - from) / (to - from);
            out.corners[out.count++] = Vertical ? TexelPoint{at, a.y + share * (b.y - a.y)}
                                                : TexelPoint{a.x + share * (b.x - a.x), at};
        }
    }
}

}  // namespace tessera
