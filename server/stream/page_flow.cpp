#include "server/stream/page_flow.h"

#include <algorithm>
#include <utility>

namespace tessera {

PageFlow::Added PageFlow::add(StreamAsk ask) {
    if (asks_.contains(ask.id)) return Added::twice;
    if (asks_.size() >= options_.asks) return Added::too_many;
    const std::uint32_t id = ask.id;
    Ask& added = asks_[id];
    added.ask = std::move(ask);
    added.number = next_number_++;
    waiting_.insert(place_of(added));
    return Added::yes;
}

void PageFlow::grant(std::uint64_t credits) noexcept {
    credits_ = std::min<std::uint64_t>(options_.credits,
                                       credits_ + std::min<std::uint64_t>(credits, options_.credits));
}

void PageFlow::remove(std::unordered_map<std::uint32_t, Ask>::iterator ask) {
    switch (ask->second.state) {
        case State::waiting:
            waiting_.erase(place_of(ask->second));
            break;
        case State::started:
            --started_;
            break;
        case State::done:
            done_.erase(place_of(ask->second));
            held_bytes_ -= ask->second.page->bytes();
            full_ = false;
            break;
    }
    asks_.erase(ask);
}

bool PageFlow::cancel(std::uint32_t id) {
    const auto found = asks_.find(id);
    if (found == asks_.end()) return false;
    remove(found);
    return true;
}

void PageFlow::clear() {
    waiting_.clear();
    done_.clear();
    started_ = held_bytes_ = 0;
    full_ = false;
    asks_.clear();
}

std::optional<PageFlow::Started> PageFlow::start() {
    const std::size_t under_way = started_ + done_.size();
    if (waiting_.empty() || credits_ == 0 || under_way >= credits_ + look_ahead ||
        under_way >= options_.pages_under_way || full_)
        return std::nullopt;
    Ask& ask = asks_.find(waiting_.begin()->id)->second;
    waiting_.erase(waiting_.begin());
    ask.state = State::started;
    ++started_;
    return Started{ask.number, ask.ask};
}

PageFlow::Ask* PageFlow::find(const Started& started) {
    const auto found = asks_.find(started.ask.id);
    const bool same = found != asks_.end() && found->second.number == started.number;
    return same && found->second.state == State::started ? &found->second : nullptr;
}

void PageFlow::set_ticket(const Started& started, PageService::Ticket ticket) {
    if (Ask* ask = find(started)) ask->ticket = std::move(ticket);
}

void PageFlow::finish(const Started& started, StreamPage page) {
    Ask* const ask = find(started);
    if (ask == nullptr) return;
    --started_;
    ask->ticket = {};
    if (!done_.empty() && held_bytes_ + page.bytes() > options_.held_bytes) {
        ask->state = State::waiting;
        waiting_.insert(place_of(*ask));
        full_ = true;
        return;
    }
    ask->state = State::done;
    held_bytes_ += page.bytes();
    ask->page = std::move(page);
    done_.insert(place_of(*ask));
}

bool PageFlow::drop(const Started& started) {
    if (find(started) == nullptr) return false;
    remove(asks_.find(started.ask.id));
    return true;
}

std::optional<StreamPage> PageFlow::take() {
    if (credits_ == 0 || done_.empty()) return std::nullopt;
    const auto found = asks_.find(done_.begin()->id);
    StreamPage page = *found->second.page;
    remove(found);
    --credits_;
    return page;
}

}  // namespace tessera
