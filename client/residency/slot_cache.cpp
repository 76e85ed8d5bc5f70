#include "client/residency/slot_cache.h"

#include <algorithm>
#include <tuple>

namespace tessera {

SlotCache::SlotCache(std::size_t slots) { resize(slots); }

std::optional<Slot> SlotCache::find(PageKey page) const {
    const auto found = slot_of_.find(page);
    if (found == slot_of_.end()) return std::nullopt;
    return found->second;
}

void SlotCache::use(Slot slot) {
    slots_[slot].used_in_frame = frame_;
    slots_[slot].used = true;
}

/// Second chance: the hand goes round the ring; a slot that was used since the last visit is passed over
/// once.
std::optional<Slot> SlotCache::victim() {
    for (std::size_t looked_at = 0; looked_at < 2 * order_.size(); ++looked_at) {
        const Slot slot = order_[hand_];
        hand_ = (hand_ + 1) % order_.size();
        Entry& entry = slots_[slot];
        if (entry.used_in_frame == frame_) continue;
        if (!entry.used) return slot;
        entry.used = false;
    }
    return std::nullopt;
}

std::optional<SlotCache::Placement> SlotCache::insert(PageKey page, bool pinned) {
    Placement placement;
    if (!free_.empty()) {
        placement.slot = free_.back();
        free_.pop_back();
        if (!pinned) order_.push_back(placement.slot);
    } else {
        const auto slot = victim();
        if (!slot) return std::nullopt;
        placement.slot = *slot;
        placement.evicted = slots_[*slot].page;
        slot_of_.erase(*placement.evicted);
        ++evictions_;
        if (pinned) {
            std::erase(order_, *slot);
            hand_ = order_.empty() ? 0 : hand_ % order_.size();
        }
    }
    slots_[placement.slot] = {page, 0, false, pinned};
    slot_of_[page] = placement.slot;
    pinned_ += pinned ? 1 : 0;
    return placement;
}

void SlotCache::remove(PageKey page) {
    const auto found = slot_of_.find(page);
    if (found == slot_of_.end() || slots_[found->second].pinned) return;
    const auto at = std::ranges::find(order_, found->second);
    if (at - order_.begin() < static_cast<std::ptrdiff_t>(hand_)) --hand_;
    order_.erase(at);
    hand_ = order_.empty() ? 0 : hand_ % order_.size();
    free_.push_back(found->second);
    slot_of_.erase(found);
}

SlotCache::Resized SlotCache::resize(std::size_t slots) {
    slots = std::max({slots, pinned_, std::size_t{1}});
    // Pinned pages stay, then the latest used
    std::vector<Slot> filled;
    for (const auto& [page, slot] : slot_of_) filled.push_back(slot);
    std::ranges::sort(filled, [&](Slot a, Slot b) {
        return std::tie(slots_[b].pinned, slots_[b].used_in_frame, a) <
               std::tie(slots_[a].pinned, slots_[a].used_in_frame, b);
    });
    Resized resized;
    for (; filled.size() > slots; filled.pop_back()) {
        resized.dropped.push_back(slots_[filled.back()].page);
        slot_of_.erase(resized.dropped.back());
        ++evictions_;
    }
    // What stays and lies beyond the end moves down into free slots
    const std::vector<Entry> before = slots_;
    slots_.resize(slots);
    std::vector<bool> taken(slots, false);
    for (const Slot slot : filled)
        if (slot < slots) taken[slot] = true;
    std::size_t next_free = 0;
    order_.clear();
    hand_ = 0;
    for (const Slot slot : filled) {
        Slot to = slot;
        if (slot >= slots) {
            while (taken[next_free]) ++next_free;
            to = static_cast<Slot>(next_free);
            taken[to] = true;
            slots_[to] = before[slot];
            slot_of_[before[slot].page] = to;
            resized.moves.push_back({before[slot].page, slot, to});
        }
        if (!before[slot].pinned) order_.push_back(to);
    }
    std::ranges::reverse(order_);  // the longest unused is looked at first
    free_.clear();
    for (std::size_t slot = slots; slot-- > 0;)
        if (!taken[slot]) free_.push_back(static_cast<Slot>(slot));
    return resized;
}

}  // namespace tessera
