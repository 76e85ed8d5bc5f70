#include "client/residency/page_versions.h"

#include <algorithm>

namespace tessera {

void PageVersions::learn(const SceneNews& news, const std::function<bool(PageKey)>& is_expected) {
    if (news.history < history_) return;  // of a history that is over
    if (news.history > history_) {
        history_ = news.history;
        told_revision_ = unsure_before_ = 0;
        for (auto& [page, entry] : entries_) entry.newest = 0;
    }
    told_revision_ = std::max(told_revision_, news.told_revision);
    unsure_before_ = std::max(unsure_before_, news.unsure_before);
    for (const StalePage& stale : news.stale) {
        const auto found = entries_.find(stale.page);
        if (found != entries_.end())
            found->second.newest = std::max(found->second.newest, stale.revision);
        else if (is_expected(stale.page))
            entries_[stale.page].newest = stale.revision;
    }
}

PageVersions::Verdict PageVersions::offer(PageKey page, const PageVersion& arrived, Step step) {
    if (arrived.history < history_) return Verdict::drop;
    if (arrived.history > history_) learn({.history = arrived.history}, [](PageKey) { return false; });
    Entry& entry = entries_[page];
    const bool is_early = arrived.validity.from > step;
    if (entry.is_held) {
        PageVersion& held = entry.version;
        if (held.history == arrived.history) {
            if (arrived.revision < held.revision) return Verdict::drop;
            if (arrived.revision == held.revision) {
                // The same edits: then steps tell which is the newer
                held.scene_revision = std::max(held.scene_revision, arrived.scene_revision);
                if (arrived.validity == held.validity) return Verdict::drop;
                if (!is_early && (held.validity.holds(step) || (!arrived.validity.holds(step) &&
                                                                arrived.validity.from < held.validity.until)))
                    return Verdict::drop;
            }
        }
        if (is_early) return Verdict::early;
    }
    entry.is_held = true;
    entry.version = arrived;
    return Verdict::show;
}

void PageVersions::confirm(PageKey page, const PageVersion& as_of) {
    const auto found = entries_.find(page);
    if (found == entries_.end() || !found->second.is_held) return;
    Entry& entry = found->second;
    if (as_of.history != history_ || as_of.revision < entry.version.revision) return;
    const std::string tag = entry.version.tag;
    entry.version = as_of;
    if (entry.version.tag.empty()) entry.version.tag = tag;
}

void PageVersions::forget_expected(PageKey page) {
    const auto found = entries_.find(page);
    if (found != entries_.end() && !found->second.is_held) entries_.erase(found);
}

const PageVersion* PageVersions::held(PageKey page) const {
    const auto found = entries_.find(page);
    return found != entries_.end() && found->second.is_held ? &found->second.version : nullptr;
}

bool PageVersions::is_stale(PageKey page, Step step) const {
    const auto found = entries_.find(page);
    if (found == entries_.end() || !found->second.is_held) return false;
    const Entry& entry = found->second;
    return entry.version.history != history_ || entry.newest > entry.version.revision || is_unsure(entry) ||
           !entry.version.validity.holds(step);
}

bool PageVersions::has_seen(PageKey page, std::uint64_t revision) const {
    const auto found = entries_.find(page);
    if (found == entries_.end() || !found->second.is_held) return false;
    const Entry& entry = found->second;
    if (entry.version.history != history_) return false;
    return entry.version.scene_revision >= revision || entry.version.revision >= revision ||
           (told_revision_ >= revision && entry.newest <= entry.version.revision && !is_unsure(entry));
}

std::uint64_t PageVersions::least_revision(PageKey page) const {
    const auto found = entries_.find(page);
    return std::max(found == entries_.end() ? 0 : found->second.newest, unsure_before_);
}

void PageVersions::mark_told(const std::function<bool(PageKey)>& is_watched) {
    for (auto& [page, entry] : entries_)
        if (entry.is_held && entry.version.history == history_ && entry.newest <= entry.version.revision &&
            !is_unsure(entry) && is_watched(page))
            entry.version.scene_revision = std::max(entry.version.scene_revision, told_revision_);
}

std::uint64_t PageVersions::least_seen(const std::function<bool(PageKey)>& is_inside) const {
    std::uint64_t least = told_revision_;
    for (const auto& [page, entry] : entries_)
        if (entry.is_held && entry.version.history == history_ && is_inside(page))
            least = std::min(least, entry.version.scene_revision);
    return least;
}

}  // namespace tessera
