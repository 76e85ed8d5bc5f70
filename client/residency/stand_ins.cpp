#include "client/residency/stand_ins.h"

#include <algorithm>
#include <utility>

#include "client/residency/coarse_cover.h"

namespace tessera {
namespace {

constexpr std::uint64_t first_wait_frames = 16;  ///< After a failure

}  // namespace

void StandIns::hear(std::vector<ArrivedPage> arrived) {
    for (ArrivedPage& answer : arrived) {
        const auto found = entries_.find(answer.page);
        if (found == entries_.end() || found->second.asked != answer.id) continue;
        Entry& entry = found->second;
        entry.asked = 0;
        if (answer.texels && answer.texels->size() == slot_bytes) {
            entry.texels = std::move(answer.texels.value());
            entry.failures = 0;
        } else {
            entry.wanted = {};
            entry.not_before = frame_ + (first_wait_frames << std::min(entry.failures++, 5));
        }
    }
}

/// Which holds lift, what they touch of what is seen, and the stand-ins that serve for it.
StandIns::Plan StandIns::plan(std::span<const NeededPage> needed, std::span<const PageHold> holds,
                              const SlotCache& cache, const PageVersions& versions,
                              const PageTable& table) const {
    // What covers for missing pages is what is seen
    std::map<PageKey, double> seen;
    for (const NeededPage& need : needed) {
        const auto resident = table.resident_for(need.key);
        PageKey page = need.key;
        while (resident && page.level < resident->level) page = parent(page);
        if (resident && versions.held(page) && cache.find(page)) seen[page] += need.pixels;
    }
    Plan plan;
    for (const PageHold& hold : holds)
        if (!hold.lifted.empty()) plan.holds.push_back(&hold);
    const auto fits = [&](PageKey page) { return all_lifted(page, plan.holds).size() <= most_lifted; };

    // Where there is no room the hold that lifts most lifts nothing, then the next
    std::vector<NeededPage> touched, targets;
    for (;; plan.holds.erase(std::ranges::max_element(
             plan.holds, {}, [](const PageHold* hold) { return hold->lifted.size(); }))) {
        touched.clear();
        for (const auto& [page, pixels] : seen)
            if (!all_lifted(page, plan.holds).empty()) touched.push_back({page, pixels});
        targets = coarse_cover(touched, most_targets(), table.extent(), fits);
        if (targets.size() <= most_targets() &&
            std::ranges::all_of(targets, [&](const NeededPage& page) { return fits(page.key); }))
            break;
    }
    for (const NeededPage& page : touched) {
        const PageVersion& held = *versions.held(page.key);
        plan.pages[page.key] = {
            page.pixels,
            {lifted_from(page.key, plan.holds), held.history, held.revision, held.validity.from}};
    }

    // What covers everything first, then what most pixels gain from
    std::ranges::stable_sort(targets, std::ranges::greater{}, &NeededPage::pixels);
    const std::vector<NeededPage> covers = coarse_cover(touched, most_covers, table.extent(), fits);
    if (covers.size() <= most_covers)
        for (const NeededPage& page : covers) plan.wanted.push_back(page.key);
    for (const NeededPage& page : targets)
        if (std::ranges::find(plan.wanted, page.key) == plan.wanted.end()) plan.wanted.push_back(page.key);
    return plan;
}

void StandIns::let_go(PageKey stand_in) {
    const auto found = entries_.find(stand_in);
    if (found->second.asked != 0) source_.cancel(found->second.asked);
    entries_.erase(found);
}

/// The stand-in that is there and shows a page best, of those but one. Null: the page does it better itself,
/// since a sprite that is missing would be worse than one that is seen twice.
const PageKey* StandIns::best_for(PageKey page, const Plan& plan, const PageKey* but) const {
    const PageKey* best = nullptr;
    bool is_right = false;
    for (const auto& [stand_in, entry] : entries_) {  // fine ones first
        if (!entry.is_there || !covers(stand_in, page) || (but && *but == stand_in)) continue;
        const Shows how = shows(entry.there, page, plan.holds);
        if (how == Shows::less || is_right || (best && how == Shows::twice)) continue;
        best = &stand_in;
        is_right = how == Shows::right;
    }
    return best;
}

/// A slot is free, if any can be: what nobody wants any more leaves last of all where nothing else would be
/// shown instead.
void StandIns::make_room(const Plan& plan) {
    if (entries_.size() < most_) return;
    const PageKey* victim = nullptr;
    for (const auto& [stand_in, entry] : entries_) {
        if (entry.is_wanted) continue;
        victim = &stand_in;
        const bool is_spare = std::ranges::all_of(plan.pages, [&](const auto& page) {
            const PageKey* best = best_for(page.first, plan);
            return !best || *best != stand_in || best_for(page.first, plan, &stand_in);
        });
        if (is_spare) break;
    }
    if (victim) let_go(PageKey{*victim});
}

/// Those that are wanted have a slot; others stay while they are the best that there is.
void StandIns::claim(const Plan& plan) {
    for (auto& [stand_in, entry] : entries_) entry.is_wanted = false;
    for (const PageKey stand_in : plan.wanted)
        if (const auto found = entries_.find(stand_in); found != entries_.end())
            found->second.is_wanted = true;
    std::vector<PageKey> useful;
    for (const auto& [page, touched] : plan.pages)
        if (const PageKey* best = best_for(page, plan)) useful.push_back(*best);
    for (auto it = entries_.begin(); it != entries_.end();) {
        const PageKey stand_in = it->first;
        const bool stays = it->second.is_wanted || std::ranges::find(useful, stand_in) != useful.end();
        ++it;
        if (!stays) let_go(stand_in);
    }
    for (const PageKey stand_in : plan.wanted) {
        if (entries_.contains(stand_in)) continue;
        make_room(plan);
        if (entries_.size() == most_) return;
        std::size_t index = 0;
        while (std::ranges::any_of(entries_, [&](const auto& one) { return one.second.index == index; }))
            ++index;
        entries_.emplace(stand_in, Entry{.index = index, .is_wanted = true});
    }
}

void StandIns::ask(const Plan& plan, Step step) {
    for (const PageKey stand_in : plan.wanted) {
        const auto found = entries_.find(stand_in);
        if (found == entries_.end() || found->second.asked != 0 || found->second.not_before > frame_)
            continue;
        // It is as new as all that it serves for
        Made made{lifted_from(stand_in, plan.holds)};
        for (const auto& [page, touched] : plan.pages) {
            if (!covers(stand_in, page)) continue;
            made.history = std::max(made.history, touched.made.history);
            made.revision = std::max(made.revision, touched.made.revision);
            made.from = std::max(made.from, touched.made.from);
        }
        Entry& entry = found->second;
        if (entry.wanted == made) continue;
        PageRequest request{.id = id_bit | next_id_,
                            .page = stand_in,
                            .least_revision = made.lifted.made_revision,
                            .step = step,
                            .urgency = Urgency::cover};
        for (const LiftedSprite& sprite : made.lifted.without) request.without.push_back(sprite.id);
        if (!source_.request(request)) return;
        next_id_ = (next_id_ + 1) & ~id_bit;
        entry.asked = request.id;
        entry.wanted = std::move(made);
    }
}

std::vector<SlotUpload> StandIns::bring(std::size_t first_slot) {
    std::vector<SlotUpload> uploads;
    for (auto& [stand_in, entry] : entries_) {
        if (entry.texels.empty()) continue;
        uploads.push_back(
            {static_cast<Slot>(first_slot + entry.index), stand_in, std::exchange(entry.texels, {})});
        entry.there = entry.wanted.lifted;
        entry.is_there = true;
    }
    return uploads;
}

void StandIns::show(const Plan& plan, std::size_t first_slot, PageTable& table) {
    std::map<PageKey, PageKey> shown;
    for (const auto& [page, touched] : plan.pages) {
        const PageKey* best = best_for(page, plan);
        if (!best) continue;
        shown.emplace(page, *best);
        const ShownPage where{static_cast<Slot>(first_slot + entries_.at(*best).index), best->level,
                              table.resident_for(page)->arrival_ms};
        if (table.shown_for(page) != where) table.show_instead(page, where);
    }
    for (const auto& [page, stand_in] : shown_)
        if (!shown.contains(page)) table.show_itself(page);
    shown_ = std::move(shown);
}

std::vector<SlotUpload> StandIns::update(std::span<const NeededPage> needed, std::span<const PageHold> holds,
                                         const SlotCache& cache, const PageVersions& versions, Step step,
                                         PageTable& table) {
    ++frame_;
    unlifted_.clear();
    if (holds.empty() && entries_.empty()) return {};
    const Plan plan = this->plan(needed, holds, cache, versions, table);
    for (const PageHold& hold : holds)
        if (!hold.lifted.empty() && std::ranges::find(plan.holds, &hold) == plan.holds.end())
            unlifted_.push_back(hold.id);
    std::vector<SlotUpload> uploads = bring(cache.capacity());
    claim(plan);
    ask(plan, step);
    show(plan, cache.capacity(), table);
    std::erase_if(uploads, [&](const SlotUpload& upload) { return !entries_.contains(upload.page); });
    return uploads;
}

bool StandIns::outlive(const PageHold& hold, const std::vector<const PageHold*>& others) const {
    return std::ranges::all_of(shown_, [&](const auto& shown) {
        const auto& [page, stand_in] = shown;
        const TexelBox box = box_of_page(page);
        if (!meets_any(box, hold.boxes) && !meets_any(box, hold.lifted_boxes)) return true;
        if (all_lifted(page, others).empty()) return true;  // the page itself is shown then
        const LiftedFrom& there = entries_.at(stand_in).there;
        return there.made_revision >= hold.revision &&
               std::ranges::none_of(hold.lifted, [&](std::uint64_t id) {
                   return std::ranges::find(there.without, id, &LiftedSprite::id) != there.without.end();
               });
    });
}

void StandIns::clear(PageTable& table) {
    while (!entries_.empty()) let_go(entries_.begin()->first);
    for (const auto& [page, stand_in] : shown_) table.show_itself(page);
    shown_.clear();
}

}  // namespace tessera
