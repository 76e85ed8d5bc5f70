#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "server/pages/page_request.h"
#include "shared/motion/validity.h"

namespace tessera {

/// In which steps the pages of animated scenes stay the same, as their evaluations found: so that a step is
/// known to be a page that is there already. Forgets what was not asked for longest, in halves. May be called
/// from any thread.
class PageIntervals {
  public:
    /// The interval of `line` that `step` lies in, if it is known.
    std::optional<Validity> find(PageId line, Step step);
    void insert(PageId line, const Validity& validity);

  private:
    static constexpr std::size_t most_kept = std::size_t{1} << 15;  ///< In each half: 5 MB or so.
    using Intervals = std::map<Step, Step>;  ///< By `from`: `until`. They do not overlap.
    struct Half {
        std::unordered_map<PageId, Intervals> lines;
        std::size_t count = 0;
    };
    static std::optional<Validity> find_in(const Half& half, PageId line, Step step);
    void keep(PageId line, const Validity& validity);

    std::mutex mutex_;
    Half recent_, before_;
};

}  // namespace tessera
