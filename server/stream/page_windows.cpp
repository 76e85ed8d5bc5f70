#include "server/stream/page_windows.h"

#include <algorithm>
#include <string>

namespace tessera {
namespace {

/// The texels of level 0 that the pages' texels, with the widest gutter, are made of.
TexelBox texels_of(const WatchedWindow& window) noexcept {
    const auto begin = [&](std::uint32_t page) {
        return (std::int64_t{page} * page_side_texels - max_gutter_texels) *
               (std::int64_t{1} << window.level);
    };
    const auto end = [&](std::uint32_t page) {
        return (std::int64_t{page} * page_side_texels + max_gutter_texels) *
               (std::int64_t{1} << window.level);
    };
    return {begin(window.x0), begin(window.y0), end(window.x1), end(window.y1)};
}

/// Halves what has changed until it is a page.
void find_stale(const PageRevisions& revisions, const WatchedWindow& window,
                std::vector<ChangedPage>& stale) {
    const Revision newest = revisions.newest_in(texels_of(window));
    if (newest <= window.told) return;
    const std::uint32_t width = window.x1 - window.x0, height = window.y1 - window.y0;
    if (width == 1 && height == 1) {
        stale.push_back({{window.level, window.x0, window.y0}, newest});
        return;
    }
    WatchedWindow first = window, second = window;
    if (width >= height)
        first.x1 = second.x0 = window.x0 + width / 2;
    else
        first.y1 = second.y0 = window.y0 + height / 2;
    find_stale(revisions, first, stale);
    find_stale(revisions, second, stale);
}

}  // namespace

Result<void> PageWindows::replace(const std::vector<Asked>& asked, Extent extent,
                                  std::optional<Revision> seen, Revision now) {
    const auto refuse = [](std::string why) { return Error{ErrorCode::malformed_request, std::move(why)}; };
    if (asked.size() > most_windows_)
        return refuse("windows: at most " + std::to_string(most_windows_) + " at a time");
    std::vector<WatchedWindow> windows;
    std::uint64_t pages = 0;
    for (const Asked& rectangle : asked) {
        if (rectangle.level > extent.n) continue;
        const auto level = static_cast<std::uint8_t>(rectangle.level);
        const std::int64_t side = extent.side_pages(level);
        const auto clip = [side](std::int64_t at) {
            return static_cast<std::uint32_t>(std::clamp<std::int64_t>(at, 0, side));
        };
        WatchedWindow window{level,
                             clip(rectangle.x0),
                             clip(rectangle.y0),
                             clip(rectangle.x1),
                             clip(rectangle.y1),
                             std::min(seen.value_or(now), now)};
        if (window.x0 >= window.x1 || window.y0 >= window.y1) continue;
        if (window.pages() > most_pages_ || (pages += window.pages()) > most_pages_)
            return refuse("windows: at most " + std::to_string(most_pages_) + " pages in all");
        for (const WatchedWindow& before : windows_)
            if (window.overlaps(before)) window.told = std::min(window.told, before.told);
        windows.push_back(window);
    }
    windows_ = std::move(windows);
    return {};
}

std::vector<ChangedPage> PageWindows::take_stale(const PageRevisions& revisions, Revision now) {
    std::vector<ChangedPage> stale;
    for (WatchedWindow& window : windows_) {
        if (window.told < now) find_stale(revisions, window, stale);
        window.told = std::max(window.told, now);
    }
    // Windows may overlap
    std::sort(stale.begin(), stale.end(),
              [](const ChangedPage& a, const ChangedPage& b) { return a.key < b.key; });
    stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
    return stale;
}

bool PageWindows::behind(Revision now) const noexcept {
    return std::any_of(windows_.begin(), windows_.end(),
                       [now](const WatchedWindow& window) { return window.told < now; });
}

void PageWindows::forget(Revision now) noexcept {
    for (WatchedWindow& window : windows_) window.told = now;
}

}  // namespace tessera
