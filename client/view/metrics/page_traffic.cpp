#include "client/view/metrics/page_traffic.h"

#include <algorithm>

namespace tessera {

void PageTraffic::add(std::span<const SlotUpload> uploads, std::span<const NeededPage> sampled,
                      const Residency& residency, ClientTime now, Step step) {
    for (const SlotUpload& upload : uploads) {
        ++received_;
        unseen_.insert(upload.page);
    }
    std::unordered_set<PageKey> missing;
    std::unordered_map<PageKey, ClientTime> stale;
    faults_ = 0;
    stalest_ = {};
    for (const NeededPage& page : sampled) {
        const auto shown = residency.table().shown_for(page.key);
        PageKey at = page.key;
        while (shown && at.level < shown->level) at = parent(at);
        if (shown && unseen_.erase(at) > 0) ++sampled_;
        if (!shown || shown->level != page.key.level) {
            missing.insert(page.key);
            faults_ += missing_.contains(page.key) ? 0 : 1;
        } else if (residency.versions().is_stale(page.key, step)) {
            const auto before = stale_since_.find(page.key);
            const ClientTime since = before == stale_since_.end() ? now : before->second;
            stale.emplace(page.key, since);
            stalest_ = std::max(stalest_, now - since);
        }
    }
    missing_ = std::move(missing);
    stale_since_ = std::move(stale);
    std::erase_if(unseen_, [&](PageKey page) { return !residency.cache().find(page); });
}

}  // namespace tessera
