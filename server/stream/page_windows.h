#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "shared/page/page_key.h"
#include "shared/result/result.h"
#include "shared/revisions/page_revisions.h"

namespace tessera {

/// A rectangle of pages of one level, inside the extent: [x0, x1) × [y0, y1), not empty.
struct WatchedWindow {
    std::uint8_t level = 0;
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    /// Its client has heard of every change up to this one.
    Revision told = 0;

    constexpr bool overlaps(const WatchedWindow& other) const noexcept {
        return level == other.level && x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
    }
    constexpr std::uint64_t pages() const noexcept { return std::uint64_t{x1 - x0} * (y1 - y0); }
};

struct ChangedPage {
    PageKey key;
    Revision revision = 0;  ///< The page's own.
    bool operator==(const ChangedPage&) const = default;
};

/// What a client shows, and so what it is told of: no queue, only what it has heard up to now. However many
/// edits there are, and however slowly the client reads, what is to be told is found when it can be sent.
class PageWindows {
  public:
    /// A client's rectangle; what lies outside the extent is left out.
    struct Asked {
        std::uint32_t level = 0;
        std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    };

    PageWindows(std::size_t most_windows, std::size_t most_pages)
        : most_windows_{most_windows}, most_pages_{most_pages} {}

    /// `seen`: the client's pages there are of this revision at least; none: it has no pages there. What was
    /// not told yet of the windows before is still told where the new ones overlap them. Error:
    /// malformed_request, and the windows stay as they were.
    Result<void> replace(const std::vector<Asked>& asked, Extent extent, std::optional<Revision> seen,
                         Revision now);

    /// The pages that edits touched since the client heard of them; now it has, up to `now`. Takes time
    /// with the pages that are stale, and little with the windows.
    std::vector<ChangedPage> take_stale(const PageRevisions& revisions, Revision now);

    /// Whether take_stale() might find something.
    bool behind(Revision now) const noexcept;
    /// The client has no pages any more: nothing up to `now` is told.
    void forget(Revision now) noexcept;

    const std::vector<WatchedWindow>& windows() const noexcept { return windows_; }

  private:
    std::size_t most_windows_, most_pages_;
    std::vector<WatchedWindow> windows_;
};

}  // namespace tessera
