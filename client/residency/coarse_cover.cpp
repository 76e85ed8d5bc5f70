#include "client/residency/coarse_cover.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace tessera {
namespace {

using Pixels = std::map<PageKey, double>;  ///< Fine pages first, as keys are ordered by their levels

/// What it would mean to show an ancestor instead of the pages of one level that lie under it.
struct Merge {
    PageKey parent;
    std::vector<PageKey> pages;
    double pixels = 0;
    std::size_t saved = 0;  ///< Pages fewer
};

std::vector<Merge> merges_of(const Pixels& cover, std::uint8_t level) {
    std::map<PageKey, Merge> merges;
    for (const auto& [page, pixels] : cover) {
        if (page.level != level) continue;
        Merge& merge = merges[parent(page)];
        merge.parent = parent(page);
        merge.pages.push_back(page);
        merge.pixels += pixels;
    }
    std::vector<Merge> all;
    for (auto& [page, merge] : merges) {
        merge.saved = merge.pages.size() - (cover.contains(page) ? 0 : 1);
        all.push_back(std::move(merge));
    }
    // The most pages for the fewest pixels; those that save nothing last, for what they may save higher up
    std::ranges::stable_sort(all, {}, [](const Merge& merge) {
        return merge.saved == 0 ? INFINITY : merge.pixels / static_cast<double>(merge.saved);
    });
    return all;
}

}  // namespace

std::vector<NeededPage> coarse_cover(std::span<const NeededPage> pages, std::size_t most, Extent extent,
                                     const std::function<bool(PageKey)>& fits) {
    Pixels cover;
    for (const NeededPage& page : pages) cover[page.key] += page.pixels;
    for (std::uint8_t level = 0; level < extent.n && cover.size() > most; ++level) {
        for (const Merge& merge : merges_of(cover, level)) {
            if (cover.size() <= most) break;
            if (!fits(merge.parent)) continue;
            for (const PageKey page : merge.pages) cover.erase(page);
            cover[merge.parent] += merge.pixels;
        }
    }
    std::vector<NeededPage> made;
    made.reserve(cover.size());
    for (auto page = cover.rbegin(); page != cover.rend(); ++page)
        made.push_back({page->first, page->second});
    return made;
}

}  // namespace tessera
