#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>

#include "server/pages/page_request.h"

namespace tessera {

/// Jobs that wait for a thread, the most urgent first; among equals coarse pages before fine ones, since they
/// show more, and otherwise in the order of arrival. Bounded. No locks: the owner has one.
template <class Job>
class EvaluationQueue {
  public:
    struct Place {
        Urgency urgency;
        std::uint8_t level = 0;
        std::uint64_t number = 0;  ///< Unique: the order of arrival.

        friend std::strong_ordering operator<=>(const Place& a, const Place& b) noexcept {
            if (const auto order = a.urgency <=> b.urgency; order != 0) return order;
            if (const auto order = a.turn() <=> b.turn(); order != 0) return order;
            return a.number <=> b.number;
        }
        friend bool operator==(const Place&, const Place&) = default;

      private:
        /// Each level is a head start of so many arrivals: a view's coarse pages come first, and yet no
        /// stream of coarse pages, however long, holds up a fine one for more than `head_start` of them a
        /// level.
        std::int64_t turn() const noexcept { return static_cast<std::int64_t>(number) - head_start * level; }
    };
    static constexpr std::int64_t head_start = 16;

    explicit EvaluationQueue(std::size_t capacity) : capacity_{capacity} {}

    bool empty() const noexcept { return jobs_.empty(); }
    std::size_t size() const noexcept { return jobs_.size(); }
    bool full() const noexcept { return jobs_.size() >= capacity_; }

    void push(Place place, std::shared_ptr<Job> job) { jobs_.emplace(place, std::move(job)); }
    void erase(Place place) { jobs_.erase(place); }

    /// The queue is not empty.
    Place least_urgent() const noexcept { return std::prev(jobs_.end())->first; }
    std::shared_ptr<Job> take_least_urgent() { return take(std::prev(jobs_.end())); }
    std::shared_ptr<Job> take_most_urgent() { return take(jobs_.begin()); }

  private:
    using Jobs = std::map<Place, std::shared_ptr<Job>>;

    std::shared_ptr<Job> take(typename Jobs::iterator position) {
        std::shared_ptr<Job> job = std::move(position->second);
        jobs_.erase(position);
        return job;
    }

    std::size_t capacity_;
    Jobs jobs_;
};

}  // namespace tessera
