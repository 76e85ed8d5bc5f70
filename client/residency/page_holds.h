#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "client/residency/needed_pages.h"
#include "client/residency/page_source.h"
#include "client/residency/page_versions.h"
#include "shared/page/texel_box.h"

namespace tessera {

/// A change that is drawn over the pages until they show it themselves: from when a hand takes something up
/// until the pages have it where it was put. All pages that the change touches show it from one frame on, so
/// that nobody sees half of it.
struct PageHold {
    std::uint32_t id = 0;           ///< The caller's; not 0.
    std::vector<TexelBox> boxes{};  ///< What the change touches.
    bool waits = false;             ///< The edit is on its way, or made: newer versions wait for each other.
    std::uint64_t revision = 0;     ///< Of the edit; 0: not known yet.
    std::vector<std::uint64_t> lifted{};   ///< Sprites that the pages leave out meanwhile …
    std::vector<TexelBox> lifted_boxes{};  ///< … where they are.
    bool operator==(const PageHold&) const = default;
};

/// What a page may show with its gutter and what lies a texel around: what an edit has to touch to touch it.
TexelBox box_of_page(PageKey page);

bool meets_any(const TexelBox& box, std::span<const TexelBox> boxes);

/// Newer versions of pages that wait until all that belong together are there.
class PageHolds {
  public:
    /// From now on these, and no others.
    void set(std::vector<PageHold> holds) { holds_ = std::move(holds); }
    const std::vector<PageHold>& holds() const { return holds_; }
    bool empty() const { return holds_.empty() && kept_.empty(); }

    /// Whether a version has to wait: it may show a change that is drawn over the pages.
    bool keeps(PageKey page, const PageVersion& version) const;
    /// Keeps it in place of an older one of that page.
    void keep(ArrivedPage page);
    /// The version that waits; null: none.
    const ArrivedPage* kept(PageKey page) const;

    /// Ends the holds of which every needed page has come, and says which. `is_settled`: whether what the
    /// page shows has all that edits up to a revision changed of it.
    std::vector<std::uint32_t> end_complete(
        std::span<const NeededPage> needed,
        const std::function<bool(PageKey page, std::uint64_t revision)>& is_settled);
    /// The pages that no hold keeps any more.
    std::vector<ArrivedPage> take_free();

  private:
    std::vector<PageHold> holds_;
    std::vector<ArrivedPage> kept_;  ///< One of a page; at most most_kept.
};

}  // namespace tessera
