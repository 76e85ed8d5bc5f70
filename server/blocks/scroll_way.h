#pragma once

#include <algorithm>
#include <cstdint>

#include "server/blocks/scroll.h"

namespace tessera {

/// Which shifts are looked at, and what changes first: on from a shift, to later steps or to earlier ones.
/// Shifts are counted from there: number k lies k shifts on.
class ScrollWay {
  public:
    ScrollWay(const Scroll& scroll, std::int64_t from, bool later, std::int64_t most) noexcept
        : scroll_{scroll}, from_{from}, later_{later} {
        // Ends lie half a span beside the multiples, so that step 0, where scenes begin, is no end
        const auto floor = [&](std::int64_t number) {
            const std::int64_t in = number % most;
            return number - (in < 0 ? in + most : in);
        };
        const std::int64_t first = floor(from + most / 2) - most / 2;
        last_ = later ? first + most - 1 - from : from - first;
        end_ = later ? begin(last_ + 1) : begin(last_);
    }

    /// Of cells that come again after `shifts`: what does not change until then never does.
    static ScrollWay around(const Scroll& scroll, std::int64_t from, bool later,
                            std::int64_t shifts) noexcept {
        ScrollWay way{scroll, from, later, 1};
        way.last_ = shifts;
        way.end_ = later ? never : always;
        return way;
    }

    bool is_later() const noexcept { return later_; }
    std::int64_t last() const noexcept { return last_; }  ///< Shift that is looked at.
    /// Whether a multiple of `most`, a power of two, lies between shifts k − 1 and k: as those that end_ lies
    /// at.
    bool is_cut(std::int64_t k, std::int64_t most) const noexcept {
        const std::int64_t number = from_ + on(k) + (later_ ? 0 : 1);
        return ((number + most / 2) & (most - 1)) == 0;
    }
    /// The first step of the later one of shifts k − 1 and k, on either way.
    Step between(std::int64_t k) const noexcept { return later_ ? enter(k) : leave(k - 1); }
    std::int64_t shifted(std::int64_t k) const noexcept { return scroll_.shifted(from_ + on(k)); }
    /// The step that is met first on the way through shift k, and the one that is met last.
    Step enter(std::int64_t k) const noexcept { return later_ ? begin(k) : begin(k - 1) - 1; }
    Step leave(std::int64_t k) const noexcept { return later_ ? begin(k + 1) - 1 : begin(k); }

    /// What is stated: until when, or from when on, nothing changes.
    Step end() const noexcept { return end_; }
    /// At the way into `step` something else is shown than before.
    void change_into(Step step) noexcept {
        end_ = later_ ? std::min(end_, step) : std::max(end_, add_steps(step, 1));
    }
    bool ended_before(Step step) const noexcept { return later_ ? end_ <= step : end_ > step; }
    /// The first step on the way that a frame, shown in `frames`, is not shown in any more.
    Step after(const Validity& frames) const noexcept {
        return later_ ? frames.until : add_steps(frames.from, -1);
    }
    bool is_beyond(Step step, std::int64_t k) const noexcept {
        return later_ ? step == never || step > leave(k) : step == always || step < leave(k);
    }
    /// From `step` on, through shift k.
    Validity within(Step step, std::int64_t k) const noexcept {
        return later_ ? Validity{step, add_steps(leave(k), 1)} : Validity{leave(k), add_steps(step, 1)};
    }
    /// Whether the way into `step` is one from shift to shift.
    bool is_shift(Step step) const noexcept {
        return (later_ ? step : add_steps(step, 1)) % static_cast<std::int64_t>(scroll_.steps) == 0;
    }
    /// The shift that a step on the way lies in.
    std::int64_t shift_of(Step step) const noexcept { return on(scroll_.shift_at(step) - from_); }
    /// How far cells run to the left from shift to shift, on this way.
    std::int64_t cells() const noexcept { return on(std::int64_t{scroll_.cells}); }

  private:
    std::int64_t on(std::int64_t k) const noexcept { return later_ ? k : -k; }
    Step begin(std::int64_t k) const noexcept { return scroll_.begin_of(from_ + on(k)); }

    const Scroll& scroll_;
    std::int64_t from_;
    bool later_;
    std::int64_t last_ = 0;
    Step end_ = 0;
};

}  // namespace tessera
