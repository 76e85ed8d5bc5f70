#include "server/stream/edit_news.h"

#include <algorithm>
#include <utility>

namespace tessera {

void EditNewsRing::add(EditNewsPtr news) {
    const std::lock_guard lock{mutex_};
    bytes_ += news->message.size();
    news_.push_back(std::move(news));
    while (news_.size() > most_ || (bytes_ > most_bytes_ && news_.size() > 1)) {
        bytes_ -= news_.front()->message.size();
        missed_to_ = news_.front()->revision;
        news_.pop_front();
    }
}

void EditNewsRing::skip(Revision revision) {
    const std::lock_guard lock{mutex_};
    news_.clear();
    bytes_ = 0;
    missed_to_ = revision;
}

EditNewsRing::Next EditNewsRing::after(Revision told) const {
    const std::lock_guard lock{mutex_};
    Next next;
    if (told < missed_to_) next.missed_to = told = missed_to_;
    const auto found = std::upper_bound(
        news_.begin(), news_.end(), told,
        [](Revision revision, const EditNewsPtr& news) { return revision < news->revision; });
    if (found != news_.end()) next.news = *found;
    return next;
}

}  // namespace tessera
