#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "client/residency/residency.h"

namespace tessera {

/// What becomes of pages between the server and the picture, frame by frame. Remembers only pages that are
/// needed or in the cache.
class PageTraffic {
  public:
    /// What residency.update() said of the frame at `now`.
    void add(std::span<const SlotUpload> uploads, std::span<const NeededPage> sampled,
             const Residency& residency, ClientTime now, Step step);

    /// Pages that the last frame needed, that were not there, and that the frame before did not need or had.
    std::size_t faults() const { return faults_; }
    /// Of the last frame: the right pages of older versions than can be had, and how long the oldest of them
    /// has been shown so.
    std::size_t stale_pages() const { return stale_since_.size(); }
    ClientTime stalest() const { return stalest_; }

    std::uint64_t received() const { return received_; }  ///< Copies of pages that came, since the start.
    std::uint64_t sampled() const { return sampled_; }    ///< Of these, those that some frame showed.

  private:
    std::unordered_set<PageKey> missing_;
    std::unordered_map<PageKey, ClientTime> stale_since_;
    std::unordered_set<PageKey> unseen_;  ///< In the cache, and no frame has shown it
    ClientTime stalest_{};
    std::size_t faults_ = 0;
    std::uint64_t received_ = 0, sampled_ = 0;
};

}  // namespace tessera
