#include "server/blocks/driven_op.h"

#include <algorithm>

namespace tessera {

void DrivenOp::run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const {
    const std::int32_t* patterns = frames_->patterns.data();
    if (!law_ || stretch.targets == nullptr) {
        std::fill_n(out, stretch.count, patterns[frame_at(stretch.parameter)]);
        return;
    }
    const std::int64_t side = std::int64_t{1} << stretch.cell_log2;
    const MotionRow middles{{stretch.x * side + side / 2, stretch.y * side + side / 2}, side, stretch.count};
    stretch.targets->laws[*law_].shown_along(middles, stretch.step, out,
                                             stretch.targets->tell_validity ? stretch.validity : nullptr);
    for (std::int32_t i = 0; i < stretch.count; ++i) out[i] = patterns[out[i]];
}

}  // namespace tessera
