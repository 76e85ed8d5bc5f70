#pragma once

#include "client/render/gl_objects.h"
#include "client/residency/page_table.h"

namespace tessera {

/// The page table as the shader reads it: an integer array texture, one layer of entries for each level.
class PageTableTexture {
  public:
    PageTableTexture(Extent extent, int window_side);

    /// Brings over the levels that changed.
    void update(PageTable& table);

    GLuint texture() const { return texture_.name(); }

  private:
    int window_side_;
    GlTexture texture_;
};

}  // namespace tessera
