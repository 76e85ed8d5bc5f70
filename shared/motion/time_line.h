#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

/// The frames of an animation one after the other, the first at rest (Lefebvre & Neyret 2003, section 3.4,
/// figure 12), and how long each is shown.
///
/// The paper's n frames last a step each. Here what counts is the *position* 0 to run() − 1: 0 is rest, and
/// each later position a step of a later frame. All but the last step of the first frame are rest before the
/// animation runs, as a·Z is: lead() of them.
class TimeLine {
  public:
    /// Steps of each frame, each at least 1, of 1 to 65536 frames.
    explicit TimeLine(std::span<const std::uint32_t> steps);

    std::int32_t frames() const noexcept { return static_cast<std::int32_t>(ends_.size()); }
    std::int64_t lead() const noexcept { return lead_; }        ///< Below 2^32.
    std::int64_t run() const noexcept { return ends_.back(); }  ///< The paper's n: 1 to 2^48.

    /// The frame at a position, 0 to run() − 1.
    std::int32_t frame_at(std::int64_t position) const noexcept;
    /// The positions that show a frame: [begin, end).
    std::int64_t begin_of(std::int32_t frame) const noexcept {
        return frame == 0 ? 0 : ends_[static_cast<std::size_t>(frame - 1)];
    }
    std::int64_t end_of(std::int32_t frame) const noexcept { return ends_[static_cast<std::size_t>(frame)]; }

  private:
    std::vector<std::int64_t> ends_;  ///< The first is 1.
    std::int64_t lead_ = 0;
};

}  // namespace tessera
