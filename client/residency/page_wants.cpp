#include "client/residency/page_wants.h"

#include <algorithm>

#include "client/residency/coarse_cover.h"

namespace tessera {
namespace {

constexpr double first_of_all = 1e15;  ///< More than any pixels × levels.
constexpr double in_order = 1e12;
constexpr int step_levels = 2;

}  // namespace

void PageWants::gain(PageKey page, double more, Urgency urgency) {
    Want& want = wants_[page];
    want.gain += more;
    want.expected += more;
    want.urgency = std::min(want.urgency, urgency);
}

/// The missing page, and where many levels are missing, every second level on the way: few coarse pages serve
/// many pixels.
template <class Visit>
void PageWants::for_steps(const Missing& missing, Visit visit) const {
    visit(missing.page);
    for (PageKey step = missing.page;
         step.level + step_levels < missing.shown && step.level < table_.extent().n;) {
        step = parent(step);
        if (step.level % step_levels == 0 && step.level >= missing.page.level + step_levels) visit(step);
    }
}

/// What each of a missing page's steps gains while the level `before` is shown there.
void PageWants::count(const Missing& missing, int before, double sign) {
    for_steps(missing, [&](PageKey step) {
        if (step.level < before) wants_[step].expected += sign * missing.pixels * (before - step.level);
    });
}

void PageWants::add(const std::vector<NeededPage>& needed, double weight, bool in_view) {
    const int nothing = table_.extent().n + 1;
    for (const NeededPage& page : needed) {
        const auto shown = table_.resident_for(page.key);
        const int level = shown ? shown->level : nothing;
        const double pixels = weight * page.pixels;
        if (shown) {
            PageKey at = page.key;
            while (at.level < level) at = parent(at);
            // The right page of an older version is as bad as two levels missing; a cover is replaced anyway
            if (versions_.is_stale(at, step_) && !waits_(at))
                gain(at, pixels * (at == page.key ? 2 : 0.25), in_view ? Urgency::renew : Urgency::prefetch);
        }
        if (level == page.key.level) continue;
        Missing missing{page.key, pixels, level, level, Urgency::prefetch};
        if (in_view) missing.urgency = level - page.key.level > 2 ? Urgency::missing : Urgency::sharpen;
        for_steps(missing, [&](PageKey step) {
            Want& want = wants_[step];
            want.gain += pixels * (level - step.level);
            want.urgency = std::min(want.urgency, missing.urgency);
            if (is_under_way_(step)) missing.expected = std::min<int>(missing.expected, step.level);
        });
        count(missing, missing.expected, 1);
        missing_.push_back(missing);
    }
}

void PageWants::add_first(PageKey page) { gain(page, 2 * first_of_all, Urgency::cover); }

void PageWants::add_cover(PageKey page) { gain(page, 1, Urgency::prefetch); }

void PageWants::add_next(PageKey page, double pixels, Step until) {
    if (wants_.contains(page)) return;
    gain(page, pixels, Urgency::renew);
    wants_[page].step = until;
}

/// As if the page had come.
void PageWants::expect(PageKey page) {
    for (Missing& missing : missing_) {
        if (page.level >= missing.expected || !covers(page, missing.page)) continue;
        count(missing, missing.expected, -1);
        missing.expected = page.level;
        count(missing, missing.expected, 1);
    }
}

/// The page to ask for next; null: none. `sharper`: rather one that makes something sharper than one that
/// makes it newer.
const PageKey* PageWants::best(bool sharper) const {
    const PageKey* best = nullptr;
    const Want* most = nullptr;
    for (const auto& [page, want] : wants_) {
        if (want.expected <= 1e-9 || is_under_way_(page)) continue;
        if (sharper && want.urgency >= Urgency::renew) continue;
        if (most && (want.expected < most->expected || (want.expected == most->expected && page < *best)))
            continue;
        best = &page;
        most = &want;
    }
    return best || !sharper ? best : this->best(false);
}

/// Where pages change faster than they come, the newest would be asked for again and again, and the view
/// would never be sharp: these take half of what is under way, as long as anything is missing.
std::vector<WantedPage> PageWants::take(std::size_t first) {
    std::size_t renewing = 0, sharpening = 0;
    const auto count_way = [&](const Want& want) {
        renewing += want.urgency == Urgency::renew ? 1 : 0;
        sharpening += want.urgency < Urgency::renew ? 1 : 0;
    };
    for (const auto& [page, want] : wants_)
        if (is_under_way_(page)) count_way(want);
    for (std::size_t rank = 0; rank < first; ++rank) {
        const PageKey* next = best(renewing >= sharpening);
        if (!next) break;
        const PageKey page = *next;
        count_way(wants_[page]);
        wants_[page].gain += in_order * static_cast<double>(first - rank);
        wants_[page].expected = 0;
        expect(page);
        wants_[page].expected = -1e300;  // taken
    }
    std::vector<WantedPage> wanted;
    wanted.reserve(wants_.size());
    for (const auto& [page, want] : wants_) {
        const PageVersion* held = versions_.held(page);
        wanted.push_back({.page = page,
                          .gain = want.gain,
                          .least_revision = versions_.least_revision(page),
                          .step = want.step.value_or(step_),
                          .urgency = want.urgency,
                          .have = held && held->history == versions_.history() ? held->tag : std::string{}});
    }
    return wanted;
}

}  // namespace tessera
