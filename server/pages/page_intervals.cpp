#include "server/pages/page_intervals.h"

#include <utility>

namespace tessera {

std::optional<Validity> PageIntervals::find_in(const Half& half, PageId line, Step step) {
    const auto intervals = half.lines.find(line);
    if (intervals == half.lines.end()) return std::nullopt;
    auto after = intervals->second.upper_bound(step);
    if (after == intervals->second.begin()) return std::nullopt;
    --after;
    if (step >= after->second) return std::nullopt;
    return Validity{after->first, after->second};
}

std::optional<Validity> PageIntervals::find(PageId line, Step step) {
    const std::lock_guard lock{mutex_};
    auto found = find_in(recent_, line, step);
    if (!found) {
        found = find_in(before_, line, step);
        if (found) keep(line, *found);
    }
    return found;
}

void PageIntervals::insert(PageId line, const Validity& validity) {
    const std::lock_guard lock{mutex_};
    keep(line, validity);
}

void PageIntervals::keep(PageId line, const Validity& validity) {
    if (recent_.count >= most_kept) before_ = std::exchange(recent_, {});
    if (recent_.lines[line].insert_or_assign(validity.from, validity.until).second) ++recent_.count;
}

}  // namespace tessera
