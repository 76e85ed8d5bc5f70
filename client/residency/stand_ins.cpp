#include "client/residency/stand_ins.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::size_t most_lifted = 64;  ///< Of a page; servers take no more

/// The sprites that some hold lifts from a page, in the order of their ids.
std::vector<std::uint64_t> lifted_from(PageKey page, std::span<const PageHold> holds) {
    std::vector<std::uint64_t> lifted;
    const TexelBox box = box_of_page(page);
    for (const PageHold& hold : holds)
        if (meets_any(box, hold.lifted_boxes))
            lifted.insert(lifted.end(), hold.lifted.begin(), hold.lifted.end());
    std::ranges::sort(lifted);
    lifted.erase(std::unique(lifted.begin(), lifted.end()), lifted.end());
    if (lifted.size() > most_lifted) lifted.resize(most_lifted);
    return lifted;
}

}  // namespace

void StandIns::hear(std::vector<ArrivedPage> arrived) {
    for (ArrivedPage& answer : arrived) {
        const auto found = entries_.find(answer.page);
        if (found == entries_.end() || found->second.asked != answer.id) continue;
        found->second.asked = 0;  // without texels: asked for again once there is another version
        if (answer.texels && answer.texels->size() == slot_bytes)
            found->second.texels = std::move(answer.texels.value());
    }
}

void StandIns::show_itself(PageKey page, Entry& entry, const SlotCache& cache, PageTable& table) {
    if (entry.asked != 0) source_.cancel(entry.asked);
    entry.asked = 0;
    const auto slot = cache.find(page);
    if (!entry.is_shown || !slot) return;
    auto where = table.shown_for(page).value();
    where.slot = *slot;
    table.show(page, where);
    entry.is_shown = false;
}

std::vector<SlotUpload> StandIns::update(std::span<const NeededPage> needed, std::span<const PageHold> holds,
                                         const SlotCache& cache, const PageVersions& versions, Step step,
                                         PageTable& table) {
    std::vector<SlotUpload> uploads;
    if (holds.empty() && entries_.empty()) return uploads;
    for (auto& [page, entry] : entries_) entry.is_wanted = false;
    std::vector<bool> taken(most_);
    for (const auto& [page, entry] : entries_) taken[entry.index] = true;
    for (const NeededPage& need : needed) {
        PageKey page = need.key;
        const auto shown = table.shown_for(page);
        while (shown && page.level < shown->level) page = parent(page);
        const PageVersion* held = versions.held(page);
        if (!shown || !held || !cache.find(page)) continue;
        Made made{lifted_from(page, holds), held->history, held->revision, held->validity.from};
        if (made.without.empty()) continue;
        auto found = entries_.find(page);
        if (found == entries_.end()) {
            const auto free = std::ranges::find(taken, false);
            if (free == taken.end()) continue;
            *free = true;
            found = entries_.emplace(page, Entry{}).first;
            found->second.index = static_cast<std::size_t>(free - taken.begin());
        }
        Entry& entry = found->second;
        if (entry.is_wanted) continue;  // it covers for another one
        entry.is_wanted = true;
        if (entry.asked == 0 && entry.wanted != made) {
            const PageRequestId id = id_bit | next_id_++;
            if (source_.request({.id = id,
                                 .page = page,
                                 .step = step,
                                 .urgency = Urgency::cover,
                                 .without = made.without})) {
                entry.asked = id;
                entry.wanted = std::move(made);
            }
        }
    }
    for (auto it = entries_.begin(); it != entries_.end();) {
        auto& [page, entry] = *it;
        const auto slot = static_cast<Slot>(cache.capacity() + entry.index);
        if (!entry.is_wanted || !cache.find(page)) {
            show_itself(page, entry, cache, table);
            it = entries_.erase(it);
            continue;
        }
        if (!entry.texels.empty()) {
            uploads.push_back({slot, page, std::move(entry.texels)});
            entry.texels.clear();
            entry.is_there = true;
        }
        const auto shown = table.shown_for(page);
        if (entry.is_there && shown && shown->slot != slot) {
            table.show(page, {slot, page.level, shown->arrival_ms});
            entry.is_shown = true;
        }
        ++it;
    }
    return uploads;
}

void StandIns::clear(const SlotCache& cache, PageTable& table) {
    for (auto& [page, entry] : entries_) show_itself(page, entry, cache, table);
    entries_.clear();
}

}  // namespace tessera
