#include "shared/motion/cycle.h"

#include <algorithm>

#include "shared/motion/cycle_place.h"

namespace tessera {

namespace {

__extension__ using Wide = __int128;

}  // namespace

std::int64_t rest_of(std::int64_t rest, std::uint64_t density) noexcept {
    if (rest == 0) return 0;
    if (density >= endless_density) return endless_rest;
    return static_cast<std::int64_t>(
        std::min<Wide>(Wide{rest} * static_cast<std::int64_t>(density) >> 16, endless_rest));
}

std::int64_t position_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept {
    if (cycle.rest >= endless_rest) return 0;
    const CyclePlace place = place_at(line, cycle, step);
    return std::max<std::int64_t>(0, place.at - place.before);
}

Shown shown_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept {
    if (cycle.rest >= endless_rest || line.frames() == 1) return {};
    const auto [at, before] = place_at(line, cycle, step);
    const std::int32_t frame = line.frame_at(std::max<std::int64_t>(0, at - before));
    const std::int64_t begin = frame == 0 ? 0 : before + line.begin_of(frame);
    return {frame, {add_steps(step, begin - at), add_steps(step, before + line.end_of(frame) - at)}};
}

std::int32_t frame_of_parameter(const TimeLine& line, std::int64_t parameter) noexcept {
    const std::int64_t clamped = std::clamp<std::int64_t>(parameter, 0, 65535);
    return line.frame_at(static_cast<std::int64_t>(Wide{clamped} * line.run() >> 16));
}

}  // namespace tessera
