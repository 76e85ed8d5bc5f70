#include "client/residency/watched_windows.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

constexpr std::uint32_t margin_pages = 4;

std::uint64_t pages_of(const PageWindow& window) {
    return std::uint64_t{window.right - window.left} * (window.bottom - window.top);
}

bool is_inside(const PageWindow& inner, const PageWindow& outer) {
    return inner.level == outer.level && inner.left >= outer.left && inner.top >= outer.top &&
           inner.right <= outer.right && inner.bottom <= outer.bottom;
}

void include(PageWindow& window, std::uint32_t left, std::uint32_t top, std::uint32_t right,
             std::uint32_t bottom) {
    if (window.right == 0) {
        window.left = left;
        window.top = top;
    }
    window.left = std::min(window.left, left);
    window.top = std::min(window.top, top);
    window.right = std::max(window.right, right);
    window.bottom = std::max(window.bottom, bottom);
}

PageWindow with_margin(const PageWindow& window, Extent extent) {
    const std::uint32_t side = extent.side_pages(window.level);
    return {window.level, window.left - std::min(window.left, margin_pages),
            window.top - std::min(window.top, margin_pages), std::min(window.right + margin_pages, side),
            std::min(window.bottom + margin_pages, side)};
}

}  // namespace

bool WatchedWindows::contains(const std::vector<PageWindow>& windows, PageKey page) {
    return std::ranges::any_of(windows, [&](const PageWindow& window) { return window.contains(page); });
}

bool WatchedWindows::follow(const std::vector<NeededPage>& needed, Extent extent) {
    std::array<PageWindow, max_level + 1> boxes{};
    for (const NeededPage& page : needed)
        include(boxes[page.key.level], page.key.x, page.key.y, page.key.x + 1, page.key.y + 1);
    std::vector<PageWindow> windows;
    bool changed = false;
    for (std::uint8_t level = 0; level <= extent.n; ++level) {
        PageWindow& box = boxes[level];
        if (box.right == 0) continue;
        box.level = level;
        if (level < extent.n)
            include(boxes[std::size_t{level} + 1], box.left / 2, box.top / 2, (box.right + 1) / 2,
                    (box.bottom + 1) / 2);
        // The window stays while it is large enough, and not much too large
        const PageWindow wide = with_margin(box, extent);
        const auto old = std::ranges::find(windows_, level, &PageWindow::level);
        const bool stays =
            old != windows_.end() && is_inside(box, *old) && pages_of(*old) <= 3 * pages_of(wide);
        windows.push_back(stays ? *old : wide);
        changed = changed || !stays;
    }
    if (needed.empty() || (!changed && windows.size() == windows_.size())) return false;
    windows_ = std::move(windows);
    return true;
}

}  // namespace tessera
