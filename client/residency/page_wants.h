#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "client/residency/needed_pages.h"
#include "client/residency/page_requests.h"
#include "client/residency/page_table.h"
#include "client/residency/page_versions.h"

namespace tessera {

/// What the eye would gain from pages that are missing or out of date, in pixels × levels.
class PageWants {
  public:
    /// All outlive this.
    PageWants(const PageTable& table, const PageVersions& versions, Step step)
        : table_{table}, versions_{versions}, step_{step} {}

    /// The pages of a view, `weight` of which counts; `in_view`: they are seen now.
    void add(const std::vector<NeededPage>& needed, double weight, bool in_view);
    /// Pages that are always to be there.
    void add_cover(PageKey page);
    /// The texels that follow at step `until`, for a page in view.
    void add_next(PageKey page, double pixels, Step until);

    /// What to ask for, in no order.
    std::vector<WantedPage> take() const;

  private:
    struct Want {
        double gain = 0;
        Urgency urgency = Urgency::prefetch;
        std::optional<Step> step;
    };
    void gain(PageKey page, double gain, Urgency urgency);

    const PageTable& table_;
    const PageVersions& versions_;
    Step step_;
    std::unordered_map<PageKey, Want> wants_;
};

}  // namespace tessera
