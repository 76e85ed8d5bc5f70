#pragma once

#include <chrono>
#include <cstdint>

#include "shared/motion/validity.h"

namespace tessera {

/// Which step a scene shows at which instant: server and clients go by the same law, each on its own clock.
struct SceneClock {
    using Time = std::chrono::sys_time<std::chrono::milliseconds>;

    Time at{};                     ///< At this instant …
    Step step = 0;                 ///< … it showed this step, from its beginning.
    double steps_per_second = 10;  ///< Above 0, at most 1000.
    Step loop_steps = 0;           ///< It begins again at step 0 after so many; 0: never.
    bool playing = true;
    bool operator==(const SceneClock&) const = default;

    /// The step and the part of it that is over, 0 to 1.
    struct Reading {
        Step step = 0;
        double part = 0;
    };
    /// At an instant; before `at` as at `at`.
    Reading read(Time now) const noexcept;

    /// The same clock, changed at an instant: nothing jumps but what is set.
    SceneClock played(Time now, bool plays) const noexcept;
    SceneClock sought(Time now, Step to) const noexcept;
    SceneClock at_rate(Time now, double rate) const noexcept;
};

}  // namespace tessera
