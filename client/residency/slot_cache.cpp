#include "client/residency/slot_cache.h"

namespace tessera {

SlotCache::SlotCache(std::size_t slots) : slots_(slots) { order_.reserve(slots); }

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
    if (filled_ < slots_.size()) {
        placement.slot = static_cast<Slot>(filled_++);
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

}  // namespace tessera
