#pragma once

#include <cstdint>
#include <vector>

#include "client/render/gl_objects.h"
#include "client/residency/page_table.h"

namespace tessera {

/// The page table as shaders read it, one layer of an array texture for each level: eight bits a channel,
/// since software rasterisers read such texels several times faster than wide integers. An entry: the slot's
/// low byte and its high one; the level of the page in it, 255 for nothing; and a tag, of each coordinate the
/// four bits above those that the window wraps. Levels are always brought over as a whole, so that an entry
/// is of the page that its place in the window stands for; the tag is to show it where one is not.
class PageTableTexture {
  public:
    PageTableTexture(Extent extent, int window_side);

    /// Brings over the levels that changed, and returns the coarsest; −1: none has.
    int update(PageTable& table);

    GLuint texture() const { return texture_.name(); }
    /// TableEntry as it is, whose tags are full and which tell when pages arrived: RGBA32UI.
    GLuint entries() const { return entries_.name(); }

  private:
    int window_side_;
    GlTexture texture_, entries_;
    std::vector<std::uint8_t> bytes_;  ///< Of one level
};

}  // namespace tessera
