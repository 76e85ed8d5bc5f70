#include "client/link/stream_asks.h"

#include <algorithm>
#include <utility>

namespace tessera {

bool StreamAsks::add(const StreamAsk& ask, Time now) {
    if (!asks_.try_emplace(ask.id, Entry{ask, now}).second) return false;
    queue_.push_back(ask.id);
    ++unsent_;
    return true;
}

StreamAsks::Cancelled StreamAsks::cancel(std::uint32_t id) {
    const auto found = asks_.find(id);
    if (found == asks_.end() || !found->second.wanted) return Cancelled::unknown;
    if (found->second.sent) return Cancelled::has_to_be_sent;
    asks_.erase(found);
    --unsent_;
    std::erase(queue_, id);  // or an ask of the same number would be sent twice
    return Cancelled::never_sent;
}

std::vector<StreamAsk> StreamAsks::take_unsent(std::size_t most) {
    std::vector<StreamAsk> taken;
    while (taken.size() < most && !queue_.empty()) {
        const auto found = asks_.find(queue_.front());
        queue_.pop_front();
        if (found == asks_.end() || found->second.sent) continue;
        found->second.sent = true;
        --unsent_;
        taken.push_back(found->second.ask);
    }
    return taken;
}

std::optional<StreamAsks::Answered> StreamAsks::answered(std::uint32_t id) {
    const auto found = asks_.find(id);
    if (found == asks_.end() || !found->second.sent) return std::nullopt;
    Answered answered{std::move(found->second.ask), found->second.wanted};
    if (!answered.wanted) --given_up_;
    asks_.erase(found);
    return answered;
}

std::vector<StreamAsk> StreamAsks::give_up(Time since, Time now) {
    std::vector<StreamAsk> late;
    for (auto& [id, entry] : asks_) {
        if (!entry.sent || !entry.wanted || entry.made >= since) continue;
        entry.wanted = false;
        entry.given_up = now;
        ++given_up_;
        late.push_back(entry.ask);
    }
    return late;
}

std::size_t StreamAsks::given_up_before(Time since) const {
    if (given_up_ == 0) return 0;
    return static_cast<std::size_t>(std::ranges::count_if(
        asks_, [&](const auto& one) { return !one.second.wanted && one.second.given_up < since; }));
}

std::vector<StreamAsk> StreamAsks::take_all() {
    std::vector<StreamAsk> all;
    for (auto& [id, entry] : asks_)
        if (entry.wanted) all.push_back(std::move(entry.ask));
    asks_.clear();
    queue_.clear();
    unsent_ = given_up_ = 0;
    return all;
}

}  // namespace tessera
