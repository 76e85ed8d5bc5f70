#pragma once

#include <algorithm>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

namespace tessera {

/// What was made for the slices that were asked for last; others are made again. Safe between threads.
template <class T>
class SliceCache {
  public:
    static constexpr std::size_t most_kept = 8;

    /// `make(slice)`: a shared_ptr to what belongs to a slice. Others wait meanwhile.
    template <class Make>
    std::shared_ptr<const T> get(std::int64_t slice, Make make) const {
        const std::lock_guard lock{mutex_};
        const auto found =
            std::find_if(kept_.begin(), kept_.end(), [&](const auto& kept) { return kept.first == slice; });
        if (found != kept_.end()) {
            kept_.splice(kept_.begin(), kept_, found);
        } else {
            kept_.emplace_front(slice, make(slice));
            if (kept_.size() > most_kept) kept_.pop_back();
        }
        return kept_.front().second;
    }

  private:
    mutable std::mutex mutex_;
    mutable std::list<std::pair<std::int64_t, std::shared_ptr<const T>>> kept_;  ///< Last used first.
};

}  // namespace tessera
