#include "shared/motion/scene_clock.h"

#include <algorithm>
#include <cmath>

namespace tessera {

SceneClock::Reading SceneClock::read(Time now) const noexcept {
    if (!playing || now <= at) return {step, 0};
    // Whole seconds first: the product of a long time and a rate keeps its parts of a step
    const std::int64_t passed = (now - at).count();
    const double seconds = std::floor(static_cast<double>(passed / 1000) * steps_per_second);
    const double left = static_cast<double>(passed / 1000) * steps_per_second - seconds +
                        static_cast<double>(passed % 1000) / 1000.0 * steps_per_second;
    const double whole = std::floor(left);
    constexpr double most = 9e18;
    Step now_step = add_steps(step, static_cast<std::int64_t>(std::min(seconds, most)));
    now_step = add_steps(now_step, static_cast<std::int64_t>(whole));
    if (loop_steps > 0 && now_step >= 0) now_step %= loop_steps;
    return {now_step, left - whole};
}

SceneClock SceneClock::played(Time now, bool plays) const noexcept {
    SceneClock next = sought(now, read(now).step);
    next.playing = plays;
    return next;
}

SceneClock SceneClock::sought(Time now, Step to) const noexcept {
    SceneClock next = *this;
    next.at = now;
    next.step = to;
    return next;
}

SceneClock SceneClock::at_rate(Time now, double rate) const noexcept {
    SceneClock next = sought(now, read(now).step);
    next.steps_per_second = rate;
    return next;
}

}  // namespace tessera
