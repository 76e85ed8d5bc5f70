#include "client/residency/residency.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "client/residency/page_wants.h"

namespace tessera {
namespace {

constexpr std::size_t most_early = 64;  ///< Pages that wait for their step: 18 MB

}  // namespace

int window_side_for(int width_pixels) { return width_pixels <= 1200 ? 32 : width_pixels <= 2400 ? 64 : 128; }

Residency::Residency(Extent extent, PageSource& source, const ResidencySettings& settings)
    : extent_{extent},
      source_{source},
      settings_{settings},
      table_{extent, settings.window_side},
      cache_{settings.slots},
      requests_{source, settings.requests},
      holds_{settings.kept},
      stand_ins_{source, settings.stand_ins} {}

ResidencyFrame Residency::update(const PlaneView& view, FrameTime time, const Sampling& sampling) {
    const PlanePoint& centre = view.camera().ground;
    table_.move_to(centre.x, centre.y);
    cache_.begin_frame();
    motion_.observe(view.camera(), time.now);

    std::vector<NeededPage> needed = need(view, sampling);
    mark_used(needed);
    hear_news();
    holds_.await(needed, extent_);
    ResidencyFrame frame;
    frame.uploads = place_arrivals(time);
    watch(needed);
    frame.ended_holds = end_holds(needed, time, frame.uploads);
    for (SlotUpload& upload : stand_ins_.update(needed, holds_.holds(), cache_, versions_, time.step, table_))
        frame.uploads.push_back(std::move(upload));
    frame.unlifted_holds = stand_ins_.unlifted_holds();
    requests_.want(wanted(view, needed, time, sampling), time.now);

    frame.lod_bias = lod_bias_;
    frame.needed = needed.size();
    double pixels = 0, sharp = 0, deficit = 0;
    for (const NeededPage& page : needed) {
        pixels += page.pixels;
        const auto shown = table_.resident_for(page.key);
        const int missing = (shown ? shown->level : extent_.n + 1) - page.key.level;
        if (missing == 0) {
            sharp += page.pixels;
            if (versions_.is_stale(page.key, time.step) && !requests_.is_given_up(page.key)) ++frame.stale;
            continue;
        }
        deficit += page.pixels * missing;
        if (!requests_.is_given_up(page.key)) ++frame.missing;
    }
    if (pixels > 0) {
        frame.resident_share = sharp / pixels;
        frame.mip_deficit = deficit / pixels;
    }
    frame.sampled = std::move(needed);
    return frame;
}

/// Pages of the pinned levels.
std::size_t Residency::pinned_room() const {
    std::size_t room = 0;
    for (int level = extent_.n; level >= 0 && level + settings_.pinned_levels > extent_.n; --level) {
        const std::size_t side = extent_.side_pages(static_cast<std::uint8_t>(level));
        room += side * side;
    }
    return room;
}

/// What shaders read for these: those beyond their level's window from a coarser one, those at its edge from
/// both, by the pixel.
std::vector<NeededPage> Residency::in_windows(std::vector<NeededPage> pages) const {
    std::map<PageKey, double> coarser;
    for (const NeededPage& page : pages) {
        PageKey at = page.key;
        double pixels = page.pixels;
        while (at.level < extent_.n && table_.is_at_edge(at)) {
            if (table_.in_window(at)) pixels = 0;  // counted there
            at = parent(at);
            coarser[at] += pixels;
        }
    }
    if (coarser.empty()) return pages;
    std::erase_if(pages, [&](const NeededPage& page) { return !table_.in_window(page.key); });
    for (NeededPage& page : pages)
        if (const auto found = coarser.find(page.key); found != coarser.end()) {
            page.pixels += found->second;
            coarser.erase(found);
        }
    for (const auto& [key, pixels] : coarser)
        if (table_.in_window(key)) pages.push_back({key, pixels});
    std::ranges::stable_sort(pages, std::greater{}, [](const NeededPage& page) { return page.key.level; });
    return pages;
}

/// Where the cache is too small for the view, coarser levels are asked for, instead of pages chasing each
/// other out of it for ever.
std::vector<NeededPage> Residency::need(const PlaneView& view, const Sampling& sampling) {
    constexpr double step = 0.25;
    const std::size_t room = cache_.capacity() - std::min(cache_.capacity() - 1, pinned_room());
    // A view that rests needs what it needed
    if (plan_.view && plan_.is_settled && plan_.room == room && plan_.sampling == sampling &&
        plan_.view->is_same(view))
        return plan_.needed;
    std::vector<NeededPage> needed;
    const double bias_before = lod_bias_;
    const auto fits = [&](double bias, double share) {
        needed = in_windows(needed_pages(view, extent_, bias, sampling));
        return static_cast<double>(needed.size()) <= share * static_cast<double>(room);
    };
    // One step sharper only where that leaves a margin: the bias does not swing
    if (lod_bias_ > 0 && fits(lod_bias_ - step, 0.9))
        lod_bias_ -= step;
    else
        while (!fits(lod_bias_, 1.0) && lod_bias_ < extent_.n) lod_bias_ += step;
    plan_ = {view, sampling, room, lod_bias_ == bias_before, needed};
    return needed;
}

/// Needed pages stay in this frame. What covers for a missing one goes last of all others.
void Residency::mark_used(const std::vector<NeededPage>& needed) {
    for (const NeededPage& page : needed) {
        const auto shown = table_.resident_for(page.key);
        if (!shown) continue;
        PageKey at = page.key;
        while (at.level < shown->level) at = parent(at);
        const Slot slot = cache_.find(at).value();  // not a stand-in's
        if (shown->level == page.key.level)
            cache_.use(slot);
        else
            cache_.touch(slot);
    }
}

void Residency::hear_news() {
    const std::uint32_t before = versions_.history();
    versions_.learn(source_.take_news(), [&](PageKey page) { return requests_.is_under_way(page); });
    if (versions_.history() != before) requests_.forgive();
}

std::vector<SlotUpload> Residency::place_arrivals(const FrameTime& time) {
    std::vector<ArrivedPage> arrived;
    std::vector<ArrivedPage> waiting;
    for (ArrivedPage& early : early_) {
        if (!versions_.held(early.page)) continue;
        // All in the frame in which their interval begins, however many: no two pages of one frame are of
        // different steps because one had to wait
        const bool is_due = early.version.validity.from <= time.step;
        (is_due ? arrived : waiting).push_back(std::move(early));
    }
    early_ = std::move(waiting);
    std::vector<PageKey> without;
    for (ArrivedPage& page : requests_.take_arrived(
             settings_.uploads_per_frame - std::min(settings_.uploads_per_frame, arrived.size()), time.now,
             &without))
        arrived.push_back(std::move(page));
    for (const PageKey page : without) versions_.forget_expected(page);
    stand_ins_.hear(requests_.take_others());
    std::vector<SlotUpload> uploads;
    for (ArrivedPage& page : arrived)
        if (auto upload = place(std::move(page), time)) uploads.push_back(std::move(*upload));
    return uploads;
}

/// Whether what is shown of a page has all that edits up to a revision changed of it.
bool Residency::is_settled(PageKey page, std::uint64_t revision) const {
    if (requests_.is_given_up(page)) return true;
    const auto shown = table_.resident_for(page);
    while (shown && page.level < shown->level) page = parent(page);
    return versions_.has_seen(page, revision);
}

/// All pages of a change that was made come in one frame, the one in which nobody draws it over them any
/// more.
std::vector<std::uint32_t> Residency::end_holds(const std::vector<NeededPage>& needed, const FrameTime& time,
                                                std::vector<SlotUpload>& uploads) {
    if (holds_.empty()) return {};
    const bool waits_for_coarser = !holds_.awaited_instead().empty();
    const std::vector<PageHold> ended = holds_.end_complete(
        needed, [&](PageKey page, std::uint64_t revision) { return is_settled(page, revision); },
        [&](const PageHold& hold, const std::vector<const PageHold*>& others) {
            return stand_ins_.outlive(hold, others);
        });
    for (ArrivedPage& page : holds_.take_free())
        if (auto upload = place(std::move(page), time)) uploads.push_back(std::move(*upload));
    std::vector<std::uint32_t> ids;
    for (const PageHold& hold : ended) {
        ids.push_back(hold.id);
        if (!waits_for_coarser) continue;
        for (const NeededPage& page : needed)
            if (meets_any(box_of_page(page.key), hold.boxes)) drop_older(page.key, hold.revision);
    }
    return ids;
}

/// Coarser pages have come for a page that has not: it is shown by these.
void Residency::drop_older(PageKey page, std::uint64_t revision) {
    std::vector<PageKey> older;
    while (!is_settled(page, revision)) {
        const auto shown = table_.resident_for(page);
        if (!shown) return;
        while (page.level < shown->level) page = parent(page);
        if (page.level == extent_.n || is_pinned(page)) return;
        older.push_back(page);
        page = parent(page);
    }
    for (const PageKey one : older) {
        cache_.remove(one);
        table_.hide(one);
        versions_.forget(one);
    }
}

std::optional<SlotUpload> Residency::place(ArrivedPage arrived, const FrameTime& time) {
    const PageKey page = arrived.page;
    if (!extent_.contains(page)) return std::nullopt;
    if (!arrived.unchanged && holds_.keeps(page, arrived.version)) {
        holds_.keep(std::move(arrived));
        return std::nullopt;
    }
    if (arrived.unchanged) {
        versions_.confirm(page, arrived.version);
        versions_.forget_expected(page);
        return std::nullopt;
    }
    switch (versions_.offer(page, arrived.version, time.step)) {
        case PageVersions::Verdict::show:
            break;
        case PageVersions::Verdict::early:
            std::erase_if(early_, [&](const ArrivedPage& other) { return other.page == page; });
            if (early_.size() < most_early) early_.push_back(std::move(arrived));
            return std::nullopt;
        case PageVersions::Verdict::drop:
            versions_.forget_expected(page);
            return std::nullopt;
    }
    // A newer version takes the place of the older one, in one upload: no frame shows half of it, or neither
    if (const auto slot = cache_.find(page))
        return SlotUpload{*slot, page, std::move(arrived.texels.value())};
    const auto placement = cache_.insert(page, is_pinned(page));
    if (!placement) {  // all in use now: it will be asked for again
        versions_.forget(page);
        return std::nullopt;
    }
    if (placement->evicted) {
        table_.hide(*placement->evicted);
        versions_.forget(*placement->evicted);
    }
    cache_.use(placement->slot);
    table_.show(page, {placement->slot, page.level, static_cast<std::uint32_t>(time.now.count())});
    return SlotUpload{placement->slot, page, std::move(arrived.texels.value())};
}

std::vector<WantedPage> Residency::wanted(const PlaneView& view, const std::vector<NeededPage>& needed,
                                          const FrameTime& time, const Sampling& sampling) {
    // Whether a page's texels for a step are here already, of the newest version that is known
    const auto waits = [&](PageKey page, Step step) {
        if (is_kept(page, step)) return true;
        return std::ranges::any_of(early_, [&](const ArrivedPage& early) {
            return early.page == page && early.version.validity.holds(step) &&
                   early.version.scene_revision >= versions_.least_revision(page);
        });
    };
    PageWants wants{table_, versions_, time.step, [&](PageKey page) { return requests_.is_under_way(page); },
                    [&](PageKey page) { return waits(page, time.step); }};
    const CreditWindow& window = requests_.window();
    const ClientTime ahead = (window.round_trip() + window.frame_time()) * 3 / 2;
    wants.add(needed, 1, true);
    wants.add({holds_.awaited_instead().begin(), holds_.awaited_instead().end()}, 1, true);
    if (const auto camera = settings_.prefetch ? motion_.in(ahead, extent_) : std::nullopt) {
        std::vector<NeededPage> soon = needed_pages(view.from(*camera), extent_, lod_bias_, sampling);
        std::erase_if(soon, [&](const NeededPage& page) { return !table_.in_window(page.key); });
        // Only as long as they do not push out what is seen now
        const auto others =
            std::ranges::count_if(soon, [&](const NeededPage& page) { return !cache_.find(page.key); });
        if (needed.size() + static_cast<std::size_t>(others) + pinned_room() <= cache_.capacity())
            wants.add(soon, 1, false);
    }
    for (int level = extent_.n; level >= 0 && is_pinned({static_cast<std::uint8_t>(level), 0, 0}); --level) {
        const auto l = static_cast<std::uint8_t>(level);
        for (std::uint32_t y = 0; y < extent_.side_pages(l); ++y)
            for (std::uint32_t x = 0; x < extent_.side_pages(l); ++x)
                if (!cache_.find({l, x, y}))
                    level == extent_.n ? wants.add_first({l, x, y}) : wants.add_cover({l, x, y});
    }
    if (time.steps_per_second > 0) {
        // The next interval's texels are under way when this one ends, and are there a frame before
        const double lead =
            std::ceil(static_cast<double>((2 * ahead).count()) * time.steps_per_second / 1000) + 1;
        const Step horizon = add_steps(time.step, static_cast<std::int64_t>(std::min(lead, 1e9)));
        for (const NeededPage& page : needed) {
            const PageVersion* held = versions_.held(page.key);
            if (!held || held->validity.until == never || held->validity.until > horizon ||
                versions_.is_stale(page.key, time.step))
                continue;
            if (!waits(page.key, held->validity.until))
                wants.add_next(page.key, page.pixels, held->validity.until);
        }
    }
    std::vector<WantedPage> pages = wants.take(requests_.room());
    if (!holds_.empty())
        std::erase_if(pages, [&](const WantedPage& want) {
            return is_kept(want.page, want.step) ||
                   (holds_.keeps_any(want.page) && !holds_.has_room_for(want.page));
        });
    return pages;
}

/// Whether the newest version of a page that is known is here, and waits for others.
bool Residency::is_kept(PageKey page, Step step) const {
    const ArrivedPage* kept = holds_.kept(page);
    return kept && kept->version.validity.holds(step) && kept->version.history == versions_.history() &&
           kept->version.scene_revision >= versions_.least_revision(page);
}

/// Pages that leave what is watched have seen what was told so far; of those that come into it, what was not.
void Residency::watch(const std::vector<NeededPage>& needed) {
    const std::vector<PageWindow> before = watched_.windows();
    if (!watched_.follow(needed, extent_)) return;
    versions_.mark_told([&](PageKey page) { return WatchedWindows::contains(before, page); });
    const std::uint64_t seen = versions_.least_seen(
        [&](PageKey page) { return watched_.contains(page) && !WatchedWindows::contains(before, page); });
    source_.watch(watched_.windows(), seen);
}

std::size_t Residency::cache_slots(std::size_t slots) const { return std::max(slots, 2 * pinned_room()); }

SlotCache::Resized Residency::resize(std::size_t slots) {
    stand_ins_.clear(table_);
    SlotCache::Resized resized = cache_.resize(cache_slots(slots));
    for (const PageKey page : resized.dropped) {
        table_.hide(page);
        versions_.forget(page);
    }
    for (const SlotCache::Move& move : resized.moves) {
        auto where = table_.resident_for(move.page).value();
        where.slot = move.to;
        table_.show(move.page, where);
    }
    settings_.slots = cache_.capacity();
    return resized;
}

}  // namespace tessera
