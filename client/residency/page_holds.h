#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "client/residency/needed_pages.h"
#include "client/residency/page_source.h"
#include "client/residency/page_versions.h"
#include "shared/page/page_key.h"
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
    std::vector<TexelBox> lifted_boxes{};  ///< … and where the pages have each of them.
    bool operator==(const PageHold&) const = default;
};

/// What a page may show with its gutter and what lies a texel around: what an edit has to touch to touch it.
TexelBox box_of_page(PageKey page);

bool meets_any(const TexelBox& box, std::span<const TexelBox> boxes);

/// Newer versions of pages that wait until all that belong together are there. Where more pages than there
/// is room for would have to wait, coarser ones wait for several: all of the change is seen from one frame
/// on, a little blurred for a moment where it is that large, which is better than half of it.
class PageHolds {
  public:
    /// `most`: pages that wait, of slot_bytes each; at least 1.
    explicit PageHolds(std::size_t most) : most_{most} {}

    /// From now on these, and no others.
    void set(std::vector<PageHold> holds) { holds_ = std::move(holds); }
    const std::vector<PageHold>& holds() const { return holds_; }
    bool empty() const { return holds_.empty() && kept_.empty(); }

    /// Once a frame, before pages come: which pages are waited for.
    void await(std::span<const NeededPage> needed, Extent extent);
    /// Where not all that is needed can wait: what is waited for instead, each for some of the needed pages.
    /// Empty: every needed page is waited for.
    std::span<const NeededPage> awaited_instead() const { return instead_; }
    /// Whether a version of the page that has to wait would find room.
    bool has_room_for(PageKey page) const;

    /// Whether a version has to wait: it may show a change that is drawn over the pages.
    bool keeps(PageKey page, const PageVersion& version) const;
    /// Whether some version of the page would have to.
    bool keeps_any(PageKey page) const;
    /// Keeps it in place of an older one of that page. Where there is no room, those go that are not waited
    /// for: they are asked for when they are needed.
    void keep(ArrivedPage page);
    std::size_t kept() const { return kept_.size(); }
    /// The version that waits; null: none.
    const ArrivedPage* kept(PageKey page) const;

    using IsSettled = std::function<bool(PageKey page, std::uint64_t revision)>;
    using Outlives = std::function<bool(const PageHold& hold, const std::vector<const PageHold*>& others)>;
    /// Ends the holds of which every awaited page has come, and returns them. `is_settled`: whether what the
    /// page shows has all that edits up to a revision changed of it. `outlives`: whether what is shown for
    /// the other holds' sake is right without this one.
    std::vector<PageHold> end_complete(
        std::span<const NeededPage> needed, const IsSettled& is_settled,
        const Outlives& outlives = [](const PageHold&, const std::vector<const PageHold*>&) { return true; });
    /// The pages that no hold keeps any more.
    std::vector<ArrivedPage> take_free();

  private:
    std::size_t most_;
    std::vector<PageHold> holds_;
    std::vector<ArrivedPage> kept_;    ///< One of a page
    std::vector<PageKey> awaited_;     ///< In order
    std::vector<NeededPage> instead_;  ///< See awaited_instead()
};

}  // namespace tessera
