#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/blocks/cell_node.h"
#include "server/blocks/cell_op.h"

namespace tessera {

/// The ops that some nodes need, in order, and where their rows lie: what runs for each stretch of cells.
class CellSchedule {
  public:
    enum class Rows : std::uint8_t {
        stretches,  ///< Cells side by side: a corner to the right is the same row, a cell further.
        corners,    ///< Every row stands alone, so that what a cell sees can be enumerated; leaves are given.
    };
    /// A random block, a map, or an animation that something else drives, at a corner: a row that the caller
    /// fills (Rows::corners).
    struct Leaf {
        std::size_t node;
        int dx, dy;
        std::size_t row;
    };

    CellSchedule(const std::vector<CellNode>& nodes, std::span<const std::size_t> roots, Rows rows);

    static constexpr std::size_t row_stride = stretch_cells + 16;
    std::size_t space() const noexcept { return rows_ * row_stride; }  ///< Integers that run() needs.

    /// `space` has room for space() integers. Where leaves are given, they are filled. `follows`: `space` is
    /// as the last run left it, and that was of this schedule and of the same cells one row above, so that
    /// what was read below that row is known.
    void run(const Stretch& stretch, std::int32_t* space, bool follows = false) const;
    /// Whether stretches may be of scattered cells: nothing looks at cells beside.
    bool scatters() const noexcept { return scatters_; }
    const std::int32_t* root(std::size_t i, const std::int32_t* space) const noexcept {
        return space + roots_[i] * row_stride;
    }
    std::span<const Leaf> leaves() const noexcept { return leaves_; }
    /// Of the schedule and its ops, which other schedules may share.
    std::size_t memory_bytes() const noexcept;

  private:
    struct Input {
        std::size_t row = 0;
        int dx = 0;
    };
    struct Step {
        std::shared_ptr<const CellOp> op;
        std::array<Input, max_inputs> inputs{};
        int input_count = 0;
        int dy = 0;
        int further = 0;  ///< Cells more than the stretch has.
        std::size_t row = 0;
        bool kept = false;  ///< Where the run follows, its row is copied.
    };
    struct Copy {
        std::size_t from, to;
        int further;
    };
    std::vector<Step> steps_;
    std::vector<Copy> copies_;        ///< Rows of leaves, from those that a run read below its cells.
    std::vector<std::size_t> roots_;  ///< Rows
    std::vector<Leaf> leaves_;
    std::size_t rows_ = 0;
    bool scatters_ = true;
};

}  // namespace tessera
