#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "client/residency/slot.h"
#include "shared/page/page_key.h"

namespace tessera {

/// What the shader reads for one page: which slot to sample, and which page the entry speaks for. As
/// uploaded: four 32-bit words.
struct TableEntry {
    static constexpr std::uint32_t nothing = 0xffffffff;

    /// Slot in the low 16 bits, the level of the page in that slot above them; or `nothing`.
    std::uint32_t shown = nothing;
    /// The full page coordinates that this entry speaks for. The table repeats every `window_side` pages, so
    /// the shader compares them: a stale entry never matches. Negative outside the extent.
    std::int32_t page_x = INT32_MIN;
    std::int32_t page_y = INT32_MIN;
    /// When the shown page came, in the caller's milliseconds: new detail fades in.
    std::uint32_t arrival_ms = 0;
    bool operator==(const TableEntry&) const = default;
};

/// The page in a slot that is shown for some key: the page itself or its finest resident ancestor.
struct ShownPage {
    Slot slot = 0;
    std::uint8_t level = 0;
    std::uint32_t arrival_ms = 0;
    bool operator==(const ShownPage&) const = default;
};

/// Page key -> slot of the page or of its finest resident ancestor: one toroidal window of
/// window_side × window_side entries for each level, around the clip centre. Moving the centre rewrites only
/// the entries that come into a window (Tanner, Migdal, Jones, "The Clipmap", SIGGRAPH 1998: the addressing;
/// storage is a cache, so nothing is held for entries that nobody looks at).
class PageTable {
  public:
    /// `window_side`: a power of two, 4 to 256. The centre starts at texel (0, 0).
    PageTable(Extent extent, int window_side);

    /// Moves the clip centre to this texel of level 0, which lies inside the extent. A window then reaches
    /// from `window_side`/2 pages before the centre's page to one less behind it.
    void move_to(std::int64_t texel_x, std::int64_t texel_y);

    /// The page is in the slot from now on; or in this slot instead of another.
    void show(PageKey page, ShownPage where);
    /// The page is in no slot any more.
    void hide(PageKey page);

    /// A resident page is shown out of another slot, which has this page or an ancestor of it (`where.level`)
    /// in another state, for as long as it is resident; its descendants, where it covers for them, too.
    void show_instead(PageKey page, ShownPage where);
    /// It is shown itself again.
    void show_itself(PageKey page);

    /// What is shown for a page of the extent, inside or outside of its level's window.
    std::optional<ShownPage> shown_for(PageKey page) const;
    /// The page itself or its finest resident ancestor, whatever is shown instead of it.
    std::optional<ShownPage> resident_for(PageKey page) const;
    bool in_window(PageKey page) const;
    /// Whether shaders may read it from the next coarser window: it is at the edge of its own, or beyond.
    bool is_at_edge(PageKey page) const;

    Extent extent() const { return extent_; }
    int window_side() const { return window_side_; }
    /// The page of `level` that holds the clip centre.
    PageKey centre_page(std::uint8_t level) const;

    /// The entries of a level as the GPU has them: entry (x & (side − 1), y & (side − 1)) for page (x, y),
    /// rows of x.
    std::span<const TableEntry> entries(std::uint8_t level) const;
    /// Levels whose entries changed since the last call, coarse first.
    std::vector<std::uint8_t> take_changed_levels();

  private:
    struct Window {
        std::int64_t left = 0;  ///< The first page of the window
        std::int64_t top = 0;
        std::vector<TableEntry> entries;
        std::vector<std::uint8_t> levels;  ///< Of the resident page that each entry shows, or `none`
        bool changed = true;
    };
    static constexpr std::uint8_t none = 255;
    struct Place {
        TableEntry& entry;
        std::uint8_t& level;
    };

    Place place(Window& window, std::int64_t x, std::int64_t y);
    void fill(std::uint8_t level, std::int64_t x, std::int64_t y);
    template <class Update>
    void for_descendants(PageKey page, Update update);
    std::optional<PageKey> cover_of(PageKey page) const;
    const ShownPage& drawn(PageKey resident) const;
    void redraw(PageKey resident);

    Extent extent_;
    int window_side_;
    std::int64_t centre_x_ = 0;
    std::int64_t centre_y_ = 0;
    std::vector<Window> windows_;  ///< By level
    std::unordered_map<PageKey, ShownPage> resident_;
    std::unordered_map<PageKey, ShownPage> instead_;  ///< Of resident pages
};

}  // namespace tessera
