#pragma once

#include <vector>

#include "client/render/gl_objects.h"
#include "client/residency/residency.h"

namespace tessera {

/// What Overlay::revision paints the resident pages by: one float a slot.
class PageMarks {
  public:
    /// Needs a current context.
    void update(const Residency& residency);
    GLuint texture() const { return texture_.name(); }

  private:
    std::vector<float> marks_;
    GlTexture texture_;
};

/// How far from new (0) to old (1) a page is, `edits` after the last that touched it; −1 where none did.
float mark_of(std::uint64_t page_revision, std::uint64_t newest_revision);

}  // namespace tessera
