#pragma once

#include <vector>

#include "client/residency/flat_piece.h"

namespace tessera {

/// The hills around the eye as triangles: rings of cells around the clip centre, each ring's twice as large
/// as those of the ring inside it, so that cells are about as large in the picture wherever they are.
/// Vertices stand at fixed places of the lattice, and cracks between rings are closed. All is relative to the
/// eye: a terrain at texel 2^37 is made of the same small numbers as one at 0.
std::vector<FlatPiece> terrain_pieces(const Surface& surface, const PlaneView& view);

/// The height of the finest mesh over a point.
double terrain_base(const Surface& surface, const PlanePoint& ground);

}  // namespace tessera
