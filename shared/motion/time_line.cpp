#include "shared/motion/time_line.h"

#include <algorithm>

namespace tessera {

TimeLine::TimeLine(std::span<const std::uint32_t> steps) : ends_(steps.size()), lead_{steps[0] - 1} {
    std::int64_t end = 1;
    for (std::size_t frame = 0; frame < steps.size(); ++frame) {
        if (frame > 0) end += steps[frame];
        ends_[frame] = end;
    }
}

std::int32_t TimeLine::frame_at(std::int64_t position) const noexcept {
    // Frames of a step each, as the paper's
    if (run() == frames()) return static_cast<std::int32_t>(position);
    return static_cast<std::int32_t>(std::upper_bound(ends_.begin(), ends_.end(), position) - ends_.begin());
}

}  // namespace tessera
