#pragma once

#include <cstddef>
#include <vector>

#include "client/render/gl_objects.h"
#include "client/residency/flat_piece.h"

namespace tessera {

/// The flat pieces of a surface as the GPU has them: corners of triangles, and each piece's rows.
class SurfaceGeometry {
  public:
    /// Needs a current context.
    void upload(const std::vector<FlatPiece>& pieces);
    /// Draws its triangles with the program in use, the nearest in front. The framebuffer has a depth buffer.
    /// `again`: over itself, only what was seen the last time.
    void draw(bool again) const;

  private:
    std::vector<float> corners_, rows_;
    GlBuffer corner_buffer_, row_buffer_;
    std::size_t corner_capacity_ = 0, row_capacity_ = 0;
};

}  // namespace tessera
