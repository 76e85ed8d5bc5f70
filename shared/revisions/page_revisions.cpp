#include "shared/revisions/page_revisions.h"

#include <algorithm>

#include "shared/revisions/revision_tree.h"

namespace tessera {
namespace {

using detail::PlaceBox;

constexpr int lookup_visits = 4096;  ///< Of nodes; beyond it, what may have touched a page did.
constexpr int most_pushes = 64;      ///< To smaller cells, for each mark.
constexpr int joining_visits = 256;  ///< Of nodes for each mark.

/// The part of `box` where pages can be; false if there is none.
bool clip(const TexelBox& box, PlaceBox& places) noexcept {
    constexpr std::int64_t low = -detail::origin, high = detail::origin - 1;
    if (box.empty() || box.x1 <= low || box.y1 <= low || box.x0 > high || box.y0 > high) return false;
    const auto place = [=](std::int64_t texel) {
        return static_cast<std::uint64_t>(std::clamp(texel, low, high) + detail::origin);
    };
    places = {place(box.x0), place(box.y0), place(box.x1 - 1), place(box.y1 - 1)};
    return true;
}

}  // namespace

void PageRevisions::mark(const TexelBox& box, Revision revision) {
    PlaceBox places;
    if (!clip(box, places)) return;
    // Fine detail only while there is room for it
    int pushes = used_bytes() < memory_bytes_ / 4 * 3 ? most_pushes : 0;
    detail::insert(root_, {0, 0, detail::plane_log2}, places, revision, pushes);
    make_room();
}

Revision PageRevisions::of(PageKey page, std::int32_t gutter) const noexcept {
    const TexelRegion region = region_of(page, gutter);
    const auto texels = [&region](std::int64_t of_level) {
        return of_level * (std::int64_t{1} << region.level);
    };
    return newest_in({texels(region.x), texels(region.y), texels(region.x + region.width),
                      texels(region.y + region.height)});
}

Revision PageRevisions::newest_in(const TexelBox& box) const noexcept {
    PlaceBox places;
    if (!root_ || !clip(box, places)) return 0;
    Revision best = 0;
    int visits = lookup_visits;
    detail::find_newest(*root_, places, best, visits);
    return best;
}

std::size_t PageRevisions::used_bytes() const noexcept {
    return root_ ? static_cast<std::size_t>(root_->weight) : 0;
}

/// Joins leaves into their parents, round and round, smaller cells first: a bounded amount for each mark,
/// while the bound on memory is not passed by much.
void PageRevisions::make_room() {
    detail::JoiningHand hand{hand_x_, hand_y_, joined_log2_, passed_log2_, joining_visits};
    while (used_bytes() > memory_bytes_ && !root_->leaf()) {
        if (hand.visits < 0) {
            if (used_bytes() <= memory_bytes_ / 8 * 9) break;
            hand.visits = joining_visits;
        }
        if (const auto cell = detail::next_to_join(*root_, hand)) {
            detail::join(root_, *cell);
        } else if (hand.visits >= 0) {
            // Once around, and it was not enough: the smallest that was passed as well
            if (hand.passed_log2 <= detail::plane_log2) hand.joined_log2 = hand.passed_log2;
            hand = {0, 0, hand.joined_log2, 255, hand.visits};
        }
    }
    hand_x_ = hand.x;
    hand_y_ = hand.y;
    joined_log2_ = hand.joined_log2;
    passed_log2_ = hand.passed_log2;
}

}  // namespace tessera
