#include "server/stream/presence_board.h"

#include <utility>

namespace tessera {

void PresenceBoard::set(Session session, std::string person) {
    const std::lock_guard lock{mutex_};
    Person& known = people_[session];
    if (known.bytes) {
        if (*known.bytes == person) return;
        changed_.erase(known.version);
    }
    known.version = ++version_;
    known.bytes = std::make_shared<const std::string>(std::move(person));
    changed_[known.version] = session;
}

void PresenceBoard::leave(Session session) {
    const std::lock_guard lock{mutex_};
    const auto known = people_.find(session);
    if (known == people_.end()) return;
    changed_.erase(known->second.version);
    people_.erase(known);
    left_.push_back({++version_, session});
    if (left_.size() > most_left) {
        forgotten_ = left_.front().version;
        left_.pop_front();
    }
}

PresenceBoard::News PresenceBoard::after(Version read, Session self, std::size_t most) const {
    const std::lock_guard lock{mutex_};
    News news;
    news.lost = read != 0 && read < forgotten_;
    news.version = version_;
    for (auto next = changed_.upper_bound(read); next != changed_.end(); ++next) {
        if (next->second == self) continue;
        if (news.people.size() == most) {
            news.more = true;
            break;
        }
        news.people.push_back(people_.find(next->second)->second.bytes);
        news.version = next->first;
    }
    if (!news.more) news.version = version_;
    // A new reader has heard of nobody who could leave
    if (read != 0)
        for (auto next = left_.rbegin(); next != left_.rend() && next->version > read; ++next)
            if (next->version <= news.version) news.left.push_back(next->session);
    return news;
}

PresenceBoard::Version PresenceBoard::version() const {
    const std::lock_guard lock{mutex_};
    return version_;
}

}  // namespace tessera
