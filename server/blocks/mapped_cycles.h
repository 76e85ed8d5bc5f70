#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/blocks/cell_node.h"

namespace tessera {

/// The cells of an animation whose rests follow from the entries of a map, and whose phases are drawn, as the
/// LEDs of a board. What one of them shows is told without running the program's ops for it.
class MappedCycles {
  public:
    /// None where the node is no such animation.
    static std::optional<MappedCycles> of(const std::vector<CellNode>& nodes, std::size_t node);

    /// What a cell in layer z shows, right as far as it lies within what is asked. `followed`: as
    /// AnimationOp::shown_within().
    Shown shown_within(const CellAt& cell, std::int64_t z, AnimationOp::Followed& followed) const;

    std::int32_t pattern_of(std::int32_t frame) const noexcept {
        return animation_->frames().patterns[static_cast<std::size_t>(frame)];
    }

  private:
    MappedCycles(const std::vector<CellNode>& nodes, std::size_t node, std::size_t phase,
                 std::shared_ptr<const StoredMap> map);

    std::shared_ptr<const AnimationOp> animation_;
    std::shared_ptr<const StoredMap> map_;
    std::int32_t least_ = 0;  ///< Of the map's values.
    std::uint64_t base_ = 0;  ///< Of the draw, …
    int phase_shift_ = 0;     ///< … whose upper bits the phase is.
    /// a·Z of each value under all settings, one value after the other; of those that no entry has, any.
    std::vector<std::int64_t> rests_;
    std::size_t settings_ = 0;
};

}  // namespace tessera
