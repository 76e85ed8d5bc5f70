#include "shared/motion/cycle.h"

#include <algorithm>

namespace tessera {

namespace {

__extension__ using Wide = __int128;

/// What is left of a + b modulo `cycle`, at least 0.
std::int64_t left_of_sum(std::int64_t a, std::int64_t b, std::int64_t cycle) noexcept {
    std::int64_t sum = 0;
    if (!__builtin_add_overflow(a, b, &sum)) {
        const std::int64_t left = sum % cycle;
        return left < 0 ? left + cycle : left;
    }
    const auto left = static_cast<std::int64_t>((Wide{a} + b) % cycle);
    return left < 0 ? left + cycle : left;
}

/// Steps before the animation runs, and from one run to the next: below 2^63.
struct Spans {
    std::int64_t before, cycle;
};
Spans spans_of(const TimeLine& line, const Cycle& cycle) noexcept {
    const std::int64_t before = cycle.rest + line.lead();
    return {before, before + line.run()};
}

}  // namespace

std::int64_t rest_of(std::int64_t rest, std::uint64_t density) noexcept {
    if (rest == 0) return 0;
    if (density >= endless_density) return endless_rest;
    return static_cast<std::int64_t>(
        std::min<Wide>(Wide{rest} * static_cast<std::int64_t>(density) >> 16, endless_rest));
}

std::int64_t position_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept {
    if (cycle.rest >= endless_rest) return 0;
    const Spans spans = spans_of(line, cycle);
    return std::max<std::int64_t>(0, left_of_sum(step, cycle.phase, spans.cycle) - spans.before);
}

Shown shown_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept {
    if (cycle.rest >= endless_rest || line.frames() == 1) return {};
    const Spans spans = spans_of(line, cycle);
    const std::int64_t at = left_of_sum(step, cycle.phase, spans.cycle);
    const std::int32_t frame = line.frame_at(std::max<std::int64_t>(0, at - spans.before));
    const std::int64_t begin = frame == 0 ? 0 : spans.before + line.begin_of(frame);
    return {frame, {add_steps(step, begin - at), add_steps(step, spans.before + line.end_of(frame) - at)}};
}

std::int32_t frame_of_parameter(const TimeLine& line, std::int64_t parameter) noexcept {
    const std::int64_t clamped = std::clamp<std::int64_t>(parameter, 0, 65535);
    return line.frame_at(clamped * line.run() >> 16);
}

}  // namespace tessera
