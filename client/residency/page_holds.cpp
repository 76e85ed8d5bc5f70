#include "client/residency/page_holds.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::size_t most_kept = 128;  ///< 36 MB

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

void PageHolds::keep(ArrivedPage page) {
    const auto found =
        std::ranges::find_if(kept_, [&](const ArrivedPage& other) { return other.page == page.page; });
    if (found != kept_.end()) {
        if (is_newer(page.version, found->version)) *found = std::move(page);
    } else if (kept_.size() < most_kept) {
        kept_.push_back(std::move(page));
    }
}

const ArrivedPage* PageHolds::kept(PageKey page) const {
    const auto found =
        std::ranges::find_if(kept_, [&](const ArrivedPage& other) { return other.page == page; });
    return found == kept_.end() ? nullptr : &*found;
}

std::vector<std::uint32_t> PageHolds::end_complete(
    std::span<const NeededPage> needed,
    const std::function<bool(PageKey page, std::uint64_t revision)>& is_settled) {
    std::vector<std::uint32_t> ended;
    const auto has_come = [&](const PageHold& hold, PageKey page) {
        const ArrivedPage* waiting = kept(page);
        return (waiting && shows(waiting->version, hold.revision)) || is_settled(page, hold.revision);
    };
    // What waits for another hold, too, would show that one's change before its time
    const auto is_free = [&](const PageHold& hold) {
        return std::ranges::none_of(kept_, [&](const ArrivedPage& page) {
            const TexelBox box = box_of_page(page.page);
            return meets_any(box, hold.boxes) && std::ranges::any_of(holds_, [&](const PageHold& other) {
                       return other.id != hold.id && std::ranges::find(ended, other.id) == ended.end() &&
                              other.waits && meets_any(box, other.boxes) &&
                              (other.revision == 0 || shows(page.version, other.revision));
                   });
        });
    };
    // Holds that wait for each other's pages end together
    std::vector<const PageHold*> complete;
    for (const PageHold& hold : holds_)
        if (hold.waits && hold.revision != 0 && std::ranges::all_of(needed, [&](const NeededPage& page) {
                return !meets_any(box_of_page(page.key), hold.boxes) || has_come(hold, page.key);
            }))
            complete.push_back(&hold);
    for (const PageHold* hold : complete) ended.push_back(hold->id);
    for (bool again = true; again;) {
        again = false;
        for (const PageHold* hold : complete) {
            const auto at = std::ranges::find(ended, hold->id);
            if (at == ended.end() || is_free(*hold)) continue;
            ended.erase(at);
            again = true;
        }
    }
    std::erase_if(holds_,
                  [&](const PageHold& hold) { return std::ranges::find(ended, hold.id) != ended.end(); });
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
