#include "client/residency/page_wants.h"

#include <algorithm>

namespace tessera {

void PageWants::gain(PageKey page, double more, Urgency urgency) {
    Want& want = wants_[page];
    want.gain += more;
    want.urgency = std::min(want.urgency, urgency);
}

/// A missing page gains its pixels × the levels that are missing there. Where many levels are missing, every
/// second level on the way is wanted too: few coarse pages serve many pixels, so they come first by their
/// gain.
void PageWants::add(const std::vector<NeededPage>& needed, double weight, bool in_view) {
    const int nothing = table_.extent().n + 1;
    for (const NeededPage& page : needed) {
        const auto shown = table_.shown_for(page.key);
        const int shown_level = shown ? shown->level : nothing;
        const double pixels = weight * page.pixels;
        if (shown) {
            PageKey at = page.key;
            while (at.level < shown_level) at = parent(at);
            // The right page of an older version is as bad as two levels missing; a cover is replaced anyway
            if (versions_.is_stale(at, step_))
                gain(at, pixels * (at == page.key ? 2 : 0.25), in_view ? Urgency::renew : Urgency::prefetch);
        }
        if (shown_level == page.key.level) continue;
        const int missing = shown_level - page.key.level;
        const Urgency urgency = !in_view      ? Urgency::prefetch
                                : missing > 2 ? Urgency::missing
                                              : Urgency::sharpen;
        gain(page.key, pixels * missing, urgency);
        for (PageKey step = page.key; step.level + 2 < shown_level && step.level < table_.extent().n;) {
            step = parent(step);
            if (step.level % 2 == 0 && step.level >= page.key.level + 2)
                gain(step, pixels * (shown_level - step.level),
                     in_view ? Urgency::missing : Urgency::prefetch);
        }
    }
}

/// First of all, the coarsest first.
void PageWants::add_cover(PageKey page) {
    constexpr double first_of_all = 1e12;
    gain(page, first_of_all * (page.level + 1), Urgency::cover);
}

void PageWants::add_next(PageKey page, double pixels, Step until) {
    if (wants_.contains(page)) return;
    gain(page, pixels, Urgency::renew);
    wants_[page].step = until;
}

std::vector<WantedPage> PageWants::take() const {
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
