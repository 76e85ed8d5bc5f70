#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "client/residency/needed_pages.h"
#include "client/residency/page_requests.h"
#include "client/residency/page_table.h"
#include "client/residency/page_versions.h"

namespace tessera {

/// What the eye would gain from pages that are missing or out of date, in pixels × levels, and in which order
/// to ask for them: each is judged by what is missing when all that were asked for before it have come.
class PageWants {
  public:
    /// All outlive this. `is_under_way`: asked for, and not here yet. `waits`: a newer version is here, and
    /// will be shown soon.
    PageWants(const PageTable& table, const PageVersions& versions, Step step,
              std::function<bool(PageKey)> is_under_way, std::function<bool(PageKey)> waits)
        : table_{table},
          versions_{versions},
          step_{step},
          is_under_way_{std::move(is_under_way)},
          waits_{std::move(waits)} {}

    /// The pages of a view, `weight` of which counts; `in_view`: they are seen now.
    void add(const std::vector<NeededPage>& needed, double weight, bool in_view);
    /// Something to show at all: the first of all wants.
    void add_first(PageKey page);
    /// A page that is always to be there; the last of all wants.
    void add_cover(PageKey page);
    /// The texels that follow at step `until`, for a page in view.
    void add_next(PageKey page, double pixels, Step until);

    /// What to ask for: `first` pages that are not under way have the largest gains, in their order.
    std::vector<WantedPage> take(std::size_t first);

  private:
    struct Want {
        double gain = 0;      ///< As long as nothing else comes
        double expected = 0;  ///< After all that is under way has come
        Urgency urgency = Urgency::prefetch;
        std::optional<Step> step;
    };
    /// A page that some pixels sample.
    struct Missing {
        PageKey page;
        double pixels = 0;
        int shown = 0;     ///< Level; extent.n + 1 where nothing is
        int expected = 0;  ///< Level that is shown when all that is under way has come
        Urgency urgency = Urgency::prefetch;
    };
    template <class Visit>
    void for_steps(const Missing& missing, Visit visit) const;
    void count(const Missing& missing, int before, double sign);
    void expect(PageKey page);
    void gain(PageKey page, double gain, Urgency urgency);
    const PageKey* best(bool sharper) const;

    const PageTable& table_;
    const PageVersions& versions_;
    Step step_;
    std::function<bool(PageKey)> is_under_way_, waits_;
    std::unordered_map<PageKey, Want> wants_;
    std::vector<Missing> missing_;
};

}  // namespace tessera
