#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/blocks/cell_node.h"
#include "server/blocks/row_hash.h"

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

    /// What was worked out for some rows of cells in one layer.
    class Rows {
      public:
        Rows();

      private:
        friend class MappedCycles;
        static constexpr std::size_t rows = 64;
        struct Key {
            bool known = false;
            std::int64_t y = 0, part = 0;
            RowKey key{};
        };
        std::vector<Key> keys_;
    };
    /// Leaves out those of some cells that are known to show their first frame throughout what is asked;
    /// those left come first, as many as it returns.
    std::size_t leave_resting_out(std::span<CellAt> cells, std::int64_t z, Rows& rows,
                                  AnimationOp::Followed& followed) const;

    std::int32_t pattern_of(std::int32_t frame) const noexcept {
        return animation_->frames().patterns[static_cast<std::size_t>(frame)];
    }

  private:
    MappedCycles(const std::vector<CellNode>& nodes, std::size_t node, std::size_t phase,
                 std::shared_ptr<const StoredMap> map);

    /// Of a cell: its phase, and its rests under all settings.
    struct Told {
        std::uint32_t phase;
        std::span<const std::int64_t> rests;
    };
    Told told_of(const CellAt& cell, RowKey key) const noexcept;
    RowKey key_of(const CellAt& cell, std::int64_t z, Rows& rows) const noexcept;

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
