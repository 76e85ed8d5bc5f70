#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <boost/smart_ptr/intrusive_ptr.hpp>

#include "shared/page/page_key.h"
#include "shared/page/texel_box.h"
#include "shared/result/result.h"
#include "shared/revisions/revision.h"

namespace tessera {

namespace detail {
struct RevisionNode;
void intrusive_ptr_add_ref(const RevisionNode* node) noexcept;
void intrusive_ptr_release(const RevisionNode* node) noexcept;
}  // namespace detail

/// Which edit last touched a page, for every page of every level, without visiting any: the boxes that edits
/// touched, in a sparse quadtree. A page's revision is never older than the last edit that touched it, and
/// newer only where boxes had to be joined to keep to the bound on memory.
///
/// A value: a copy costs nothing and never changes when the other does. One thread marks; any may read
/// copies. The same marks in the same order give the same answers, also when saved and loaded in between.
class PageRevisions {
  public:
    /// Little memory: far edits long ago are joined, and pages between them are sent once more.
    explicit PageRevisions(std::size_t memory_bytes = std::size_t{32} << 20) : memory_bytes_{memory_bytes} {}

    /// Edit `revision`, not less than those before, changed texels of `box` and nothing else: grown by the
    /// support of the blocks that read what it changed, but not by gutters. What lies outside ±2^39 is
    /// ignored, since no page reaches there.
    void mark(const TexelBox& box, Revision revision);

    /// The last edit that touched the page or `gutter` texels of its level around it; 0 if none did.
    Revision of(PageKey page, std::int32_t gutter) const noexcept;

    /// The last edit that touched `box`; 0 if none did.
    Revision newest_in(const TexelBox& box) const noexcept;

    /// That is used, roughly: at most an eighth more than was allowed.
    std::size_t used_bytes() const noexcept;

    /// All of it, for a snapshot. Loading says invalid_input if these are not bytes that save() made.
    std::string save() const;
    static Result<PageRevisions> load(std::string_view bytes, std::size_t memory_bytes);

  private:
    void make_room();

    boost::intrusive_ptr<detail::RevisionNode> root_;
    std::size_t memory_bytes_;
    // How far joining has come: the last place along the tree's order, and the size of cells that are joined
    std::uint64_t hand_x_ = 0, hand_y_ = 0;
    std::uint8_t joined_log2_ = 8, passed_log2_ = 255;
};

}  // namespace tessera
