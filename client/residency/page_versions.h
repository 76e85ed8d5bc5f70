#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "client/residency/page_source.h"

namespace tessera {

/// Which version of each page is held, and which of these are out of date. A held page stays shown until a
/// newer version replaces it; an older one never does.
class PageVersions {
  public:
    /// `is_expected`: whether a page that is not held is under way; what is told of others is of no interest.
    void learn(const SceneNews& news, const std::function<bool(PageKey)>& is_expected);

    /// What to do with a version that arrived.
    enum class Verdict {
        show,   ///< It is held from now on.
        early,  ///< Its steps are yet to come: offer it again then.
        drop,   ///< What is held is as new.
    };
    Verdict offer(PageKey page, const PageVersion& arrived, Step step);
    /// What is held is still right, as of this version.
    void confirm(PageKey page, const PageVersion& as_of);
    /// An expected page does not come, or a held one is held no more.
    void forget(PageKey page) { entries_.erase(page); }
    void forget_expected(PageKey page);

    /// Nothing if the page is not held.
    const PageVersion* held(PageKey page) const;
    /// Whether a newer version of a held page is to be had at this step.
    bool is_stale(PageKey page, Step step) const;
    /// Whether a held page has all that edits up to a revision changed of it, as far as was told.
    bool has_seen(PageKey page, std::uint64_t revision) const;
    /// The scene's revision that the next copy of the page has to have seen.
    std::uint64_t least_revision(PageKey page) const;

    std::uint32_t history() const { return history_; }
    std::uint64_t told_revision() const { return told_revision_; }
    /// All that is held inside `is_watched` has seen what was told so far.
    void mark_told(const std::function<bool(PageKey)>& is_watched);
    /// The least revision that any held page in `is_inside` has seen; told_revision() if there is none.
    std::uint64_t least_seen(const std::function<bool(PageKey)>& is_inside) const;

  private:
    struct Entry {
        bool is_held = false;
        PageVersion version{};
        std::uint64_t newest = 0;  ///< The page's own revision, as told
    };
    bool is_unsure(const Entry& entry) const { return entry.version.scene_revision < unsure_before_; }

    std::unordered_map<PageKey, Entry> entries_;  ///< Of pages that are held or expected
    std::uint32_t history_ = 0;
    std::uint64_t told_revision_ = 0;
    std::uint64_t unsure_before_ = 0;
};

}  // namespace tessera
