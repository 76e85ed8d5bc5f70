#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "client/residency/page_source.h"

namespace tessera::testing {

/// A page source that paints its pages and delivers them in random order, some at a time.
class FakePageSource : public PageSource {
  public:
    using Paint = std::function<std::string(PageKey)>;

    explicit FakePageSource(Paint paint, unsigned seed = 1) : paint_{std::move(paint)}, random_{seed} {}

    bool request(const PageRequest& request) override {
        if (under_way_.size() >= capacity) return false;
        asked.push_back(request.page);
        most_under_way = std::max(most_under_way, under_way_.size() + 1);
        duplicate_requests += under_way_.emplace(request.page, request.id).second ? 0 : 1;
        return true;
    }
    void cancel(PageRequestId id) override {
        for (const auto& [page, other] : under_way_)
            if (other == id) cancelled_.insert(page);
    }

    std::vector<ArrivedPage> take_arrived(std::size_t most) override {
        std::vector<std::pair<PageKey, PageRequestId>> ready(under_way_.begin(), under_way_.end());
        std::shuffle(ready.begin(), ready.end(), random_);
        ready.resize(std::min({ready.size(), most, deliver_at_once}));
        std::vector<ArrivedPage> arrived;
        for (const auto& [page, id] : ready) {
            under_way_.erase(page);
            if (cancelled_.erase(page) > 0) {
                arrived.push_back({id, page, Error{ErrorCode::cancelled, "cancelled"}});
            } else if (failing) {
                arrived.push_back({id, page, *failing});
            } else {
                arrived.push_back({id, page, paint_(page)});
            }
        }
        return arrived;
    }

    std::size_t under_way() const { return under_way_.size(); }
    const std::set<PageKey>& cancelled() const { return cancelled_; }

    std::size_t capacity = 1000;
    std::size_t deliver_at_once = 1000;
    std::optional<Error> failing;
    std::vector<PageKey> asked;
    std::size_t most_under_way = 0;
    int duplicate_requests = 0;

  private:
    Paint paint_;
    std::mt19937 random_;
    std::map<PageKey, PageRequestId> under_way_;
    std::set<PageKey> cancelled_;
};

inline std::string blank_page(PageKey) { return std::string(slot_bytes, '\x7f'); }

}  // namespace tessera::testing
