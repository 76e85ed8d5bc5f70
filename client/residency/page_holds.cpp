#include "client/residency/page_holds.h"

#include <algorithm>

#include "client/residency/coarse_cover.h"

namespace tessera {
namespace {

bool shows(const PageVersion& version, std::uint64_t revision) {
    return version.scene_revision >= revision || version.revision >= revision;
}

bool is_newer(const PageVersion& a, const PageVersion& b) {
    if (a.history != b.history) return a.history > b.history;
    if (a.revision != b.revision) return a.revision > b.revision;
    return a.validity.from >= b.validity.from;
}

}  // namespace

TexelBox box_of_page(PageKey page) {
    const std::int64_t texel = std::int64_t{1} << page.level, side = page_side_texels * texel,
                       margin = (gutter_texels + 1) * texel;
    return TexelBox{page.x * side, page.y * side, (page.x + 1) * side, (page.y + 1) * side}.grown(margin);
}

bool meets_any(const TexelBox& box, std::span<const TexelBox> boxes) {
    return std::ranges::any_of(boxes, [&](const TexelBox& other) { return box.meets(other); });
}

bool PageHolds::keeps(PageKey page, const PageVersion& version) const {
    return std::ranges::any_of(holds_, [&](const PageHold& hold) {
        return hold.waits && (hold.revision == 0 || shows(version, hold.revision)) &&
               meets_any(box_of_page(page), hold.boxes);
    });
}

bool PageHolds::keeps_any(PageKey page) const {
    return std::ranges::any_of(
        holds_, [&](const PageHold& hold) { return hold.waits && meets_any(box_of_page(page), hold.boxes); });
}

void PageHolds::await(std::span<const NeededPage> needed, Extent extent) {
    std::vector<NeededPage> pages;
    for (const NeededPage& page : needed)
        if (keeps_any(page.key)) pages.push_back(page);
    instead_.clear();
    if (pages.size() > most_) {
        pages = coarse_cover(pages, most_, extent, [](PageKey) { return true; });
        instead_ = pages;
    }
    awaited_.clear();
    for (const NeededPage& page : pages) awaited_.push_back(page.key);
    std::ranges::sort(awaited_);
}

bool PageHolds::has_room_for(PageKey page) const {
    return std::ranges::binary_search(awaited_, page) ||
           (instead_.empty() && (kept_.size() < most_ || kept(page)));
}

void PageHolds::keep(ArrivedPage page) {
    const auto found =
        std::ranges::find_if(kept_, [&](const ArrivedPage& other) { return other.page == page.page; });
    if (found != kept_.end()) {
        if (is_newer(page.version, found->version)) *found = std::move(page);
        return;
    }
    if (!has_room_for(page.page)) return;
    if (kept_.size() >= most_) {
        const auto other = std::ranges::find_if(
            kept_, [&](const ArrivedPage& one) { return !std::ranges::binary_search(awaited_, one.page); });
        if (other != kept_.end()) kept_.erase(other);
    }
    kept_.push_back(std::move(page));
}

const ArrivedPage* PageHolds::kept(PageKey page) const {
    const auto found =
        std::ranges::find_if(kept_, [&](const ArrivedPage& other) { return other.page == page; });
    return found == kept_.end() ? nullptr : &*found;
}

std::vector<PageHold> PageHolds::end_complete(std::span<const NeededPage> needed, const IsSettled& is_settled,
                                              const Outlives& outlives) {
    const std::span<const NeededPage> awaited = instead_.empty() ? needed : instead_;
    const auto has_come = [&](const PageHold& hold, PageKey page) {
        const ArrivedPage* waiting = kept(page);
        return (waiting && shows(waiting->version, hold.revision)) || is_settled(page, hold.revision);
    };
    std::vector<const PageHold*> ending;
    const auto ends = [&](const PageHold& hold) { return std::ranges::find(ending, &hold) != ending.end(); };
    // What waits for another hold, too, would show that one's change before its time
    const auto is_free = [&](const PageHold& hold) {
        std::vector<const PageHold*> others;
        for (const PageHold& other : holds_)
            if (!ends(other)) others.push_back(&other);
        return outlives(hold, others) && std::ranges::none_of(kept_, [&](const ArrivedPage& page) {
                   const TexelBox box = box_of_page(page.page);
                   return meets_any(box, hold.boxes) &&
                          std::ranges::any_of(others, [&](const PageHold* other) {
                              return other->waits && meets_any(box, other->boxes) &&
                                     (other->revision == 0 || shows(page.version, other->revision));
                          });
               });
    };
    // Holds that wait for each other's pages end together
    for (const PageHold& hold : holds_)
        if (hold.waits && hold.revision != 0 && std::ranges::all_of(awaited, [&](const NeededPage& page) {
                return !meets_any(box_of_page(page.key), hold.boxes) || has_come(hold, page.key);
            }))
            ending.push_back(&hold);
    const auto bound = [&] {
        return std::ranges::find_if(ending, [&](const PageHold* hold) { return !is_free(*hold); });
    };
    for (auto one = bound(); one != ending.end(); one = bound()) ending.erase(one);
    std::vector<PageHold> ended;
    for (const PageHold* hold : ending) ended.push_back(*hold);
    std::erase_if(holds_, [&](const PageHold& hold) {
        return std::ranges::any_of(ended, [&](const PageHold& one) { return one.id == hold.id; });
    });
    return ended;
}

std::vector<ArrivedPage> PageHolds::take_free() {
    std::vector<ArrivedPage> free;
    std::erase_if(kept_, [&](ArrivedPage& page) {
        if (keeps(page.page, page.version)) return false;
        free.push_back(std::move(page));
        return true;
    });
    return free;
}

}  // namespace tessera
