#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "server/blocks/animation_op.h"
#include "server/blocks/cell_op.h"

namespace tessera {

/// Animation Map (3.4) that something else than the clock drives: the distance to targets (4 and figure 21
/// a), or a parameter of the request. See shared/motion.
class DrivenOp final : public CellOp {
  public:
    /// `law`: the index of its TargetDistance among those of a region; none: the request drives it.
    DrivenOp(std::shared_ptr<const FrameLine> frames, std::optional<std::size_t> law)
        : frames_{std::move(frames)}, law_{law} {}

    bool scatters() const noexcept override { return false; }
    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override;

    bool looks_at_targets() const noexcept { return law_.has_value(); }
    const FrameLine& frames() const noexcept { return *frames_; }
    /// Where no target is near.
    std::int32_t frame_at(std::int32_t parameter) const noexcept {
        return law_ ? 0 : frame_of_parameter(frames_->line, parameter);
    }

  private:
    std::shared_ptr<const FrameLine> frames_;
    std::optional<std::size_t> law_;
};

}  // namespace tessera
