#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/motion/cycle.h"
#include "shared/motion/targets.h"

namespace tessera {

inline constexpr std::int32_t stretch_cells = 1024;
inline constexpr std::int32_t max_reach = 4;  ///< Corners of corners: so many cells further.

/// What an enumeration asks an animation instead of a step: how often it shows a frame, or what its cells'
/// cycles are, under one of its settings.
struct AnimationProbe {
    std::size_t setting = 0;
    std::int32_t frame = 0;    ///< Is shown, …
    double* shares = nullptr;  ///< … and what share of all steps it is, is multiplied to these.
    Cycle* cycles = nullptr;
};

/// A cell where it stands, asked for at a step of its own.
struct CellAt {
    std::int64_t x = 0, y = 0;
    Step step = 0;
    Validity within{};  ///< Holds at the step: beyond it nobody asks how long its frame is shown.
};

/// Cells of one row that are worked on at a time, or some that lie here and there.
struct Stretch {
    std::int64_t x = 0;
    std::int64_t y = 0;
    std::int64_t z = 0;
    std::int64_t step = 0;
    std::int32_t count = 0;                 ///< At most stretch_cells + max_reach.
    const std::uint16_t* types = nullptr;   ///< Of these cells, where something is typed.
    Validity* validity = nullptr;           ///< Animations narrow it to the steps in which no cell changes.
    const AnimationProbe* probe = nullptr;  ///< Asked instead of the step.
    std::int32_t parameter = 0;             ///< As TexelRegion's.
    const TargetDistances* targets = nullptr;
    int cell_log2 = 0;  ///< Of the grid: a cell's side in texels.
    /// `count` cells, instead of x, y, step and validity: only for ops that say they take them.
    const CellAt* scattered = nullptr;
    Validity* frames = nullptr;  ///< Of each of those; narrowed, and right as far as it lies within.
};

/// One small function of the graph, over a stretch of cells: integers, or numbers in steps of 2^-16. Called
/// once a stretch; its loops are over cells.
class CellOp {
  public:
    virtual ~CellOp() = default;
    CellOp() = default;
    CellOp(const CellOp&) = delete;
    CellOp& operator=(const CellOp&) = delete;

    /// `in`: a row of integers for each input; where an input is read at corners, four rows in its place.
    virtual void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const = 0;
    /// Whether it takes scattered cells: what does not ask where a cell is does.
    virtual bool scatters() const noexcept { return true; }
    virtual std::size_t memory_bytes() const noexcept { return 0; }
};

inline constexpr std::size_t max_inputs = 16;

/// Numbers are held in steps of 2^-16.
inline constexpr std::int32_t number_one = 65536;

}  // namespace tessera
