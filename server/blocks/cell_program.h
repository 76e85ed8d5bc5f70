#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/blocks/scroll.h"
#include "server/blocks/stored_map.h"
#include "shared/motion/targets.h"
#include "shared/motion/validity.h"

namespace tessera {

/// A stretch of a row of cells.
struct CellRow {
    std::int64_t x = 0;  ///< First cell; |x|, |y| < 2^40.
    std::int64_t y = 0;
    std::int32_t count = 0;  ///< At most 4096.
    std::int64_t z = 0;      ///< The layer of cells, where a grid has a third dimension.
    std::int64_t step = 0;   ///< The animation clock.
    const std::uint16_t* types =
        nullptr;  ///< Of these cells in the grid's quadtree; needed if needs_types().
    /// Narrowed, if given, to the steps in which no cell's frame changes; where cells scroll, of cells as
    /// they stand: see through_shifts().
    Validity* validity = nullptr;
    std::int32_t parameter = 0;  ///< As TexelRegion's.
    const TargetDistances* targets = nullptr;
};

/// What a cell shows.
struct Look {
    std::int32_t pattern = -1;  ///< −1: nothing.
    std::uint16_t x = 0;  ///< 65535ths of the free room, or, where instances may hang over, of the cell.
    std::uint16_t y = 0;
    std::uint8_t turn = 0;   ///< Steps of TransformPlan.
    std::uint8_t scale = 0;  ///< Steps of TransformPlan.
    bool operator==(const Look&) const = default;
};

class SeenCells;

/// Places of cells in a rectangle, at a step.
struct CellBlock {
    std::int64_t x = 0, y = 0;  ///< |x|, |y| < 2^40.
    std::int32_t width = 0, height = 0;
    std::int64_t z = 0;
    Step step = 0;
    std::int32_t parameter = 0;  ///< As CellRow's.
    const TargetDistances* targets = nullptr;
};

/// Whether nobody can tell them apart: where nothing is shown, it does not matter how.
inline bool shows_same(const Look& a, const Look& b) noexcept {
    return a == b || (a.pattern < 0 && b.pattern < 0);
}

/// What a look's probability is, wherever it lies in its cell.
struct LookShare {
    std::int32_t pattern = -1;
    std::uint8_t turn = 0;
    std::uint8_t scale = 0;
    double share = 0;
};

/// Steps for which how often cells show what is told at once.
struct Epoch {
    Validity validity{};
    Step step = 0;
    /// The shares are each frame's share of all steps; else they are those of the steps in `validity`.
    bool average = true;
    std::size_t setting = 0;  ///< Of the animation; counts with `average`.
    /// Of looks at any step in `validity`, at most so much of the shares lies elsewhere.
    double uneven = 0;
    std::int32_t parameter = 0;  ///< Of the request.
};

/// The one map whose entries shift the probabilities over the plane.
struct VaryingMap {
    enum class Sampling : std::uint8_t {
        nearest,   ///< The entry that the cell lies in. State: one integer, at the cell.
        dithered,  ///< One of the four entries around, as often as bilinear weights say. State: one integer.
        dithered_x,
        dithered_y,
    };
    const StoredMap* map = nullptr;  ///< Lives as long as the program.
    Sampling sampling = Sampling::nearest;
    bool corners =
        false;  ///< A cell depends on the states of (i, j), (i+1, j), (i, j+1), (i+1, j+1): four integers.
    bool nested = false;        ///< Dithered by nested thresholds; else every cell (or corner) by itself.
    bool shared_draws = false;  ///< Cells share other draws than the map's with their neighbours, at corners.
};

/// The compiled decisions of one reference texture: what each cell of its grid shows. Integers only;
/// immutable; random access; the same cell gives the same look on every machine, in whatever stretch it is
/// asked for.
class CellProgram {
  public:
    virtual ~CellProgram() = default;
    CellProgram() = default;
    CellProgram(const CellProgram&) = delete;
    CellProgram& operator=(const CellProgram&) = delete;

    /// The patterns alone, for textures without a transform: row.count integers, −1 for nothing.
    virtual void patterns(const CellRow& row, std::int32_t* out) const = 0;
    virtual void looks(const CellRow& row, Look* out) const = 0;

    /// What a cell depends on, beside constants.
    enum class Basis : std::uint8_t {
        constant,  ///< Nothing: every cell looks the same.
        typed,     ///< Its type only: look_of_type() says all, and sums over cells are exact at every level.
        stationary,  ///< Draws whose probabilities are the same everywhere: shares() says all.
        varying,     ///< Draws, and one map: varying() and shares() say all.
        other,       ///< Several maps, or more states than may be listed: only cells themselves tell.
    };
    virtual Basis basis() const noexcept = 0;
    virtual bool needs_types() const noexcept = 0;
    /// Draws of neighbouring cells are independent of each other (corners shared by neighbours aside).
    virtual bool independent_cells() const noexcept = 0;

    virtual Look look_of_type(std::uint16_t type) const = 0;  ///< Basis typed or constant.
    virtual std::optional<VaryingMap> varying() const = 0;    ///< Basis varying.
    /// How often a cell shows what, where the map's states are given: none (constant, typed, stationary),
    /// one, or four. Shares sum to 1; blank is listed too. Basis other: empty. Where looks move, of all steps
    /// all settings of the animation, and all frames that targets or requests may call for: every look that
    /// can occur is listed.
    virtual std::vector<LookShare> shares(std::span<const std::int32_t> states) const = 0;

    /// Whether looks change with the step, with targets or with a request's parameter. Their basis is
    /// stationary, varying or other.
    virtual bool moves() const noexcept { return false; }
    virtual bool clocked() const noexcept { return false; }           ///< With the step alone.
    virtual bool looks_at_targets() const noexcept { return false; }  ///< With the targets near a cell.
    /// How places scroll over cells: patterns() and looks() are of cells so far to the right of those that
    /// are asked for.
    virtual Scroll scroll() const noexcept { return {}; }
    /// Of cells that scroll: the steps around `block.step` in which no place of the block shows another
    /// frame. `frames`: what patterns() or looks() narrowed for all of the block; `seen`: what they showed.
    virtual Validity through_shifts(const CellBlock& block, const SeenCells& seen,
                                    const Validity& frames) const {
        static_cast<void>(block), static_cast<void>(seen);
        return frames;
    }
    /// The same of what they are expected to show: of the entries of varying()'s map that they lie in.
    virtual Validity through_map(const CellBlock& block) const { return scroll().at(block.step).validity; }
    /// The steps around `step` whose shares are the same, or, if that leaves no more than `most_uneven` of
    /// them elsewhere, are the same on average. No target is near.
    virtual Epoch epoch(Step step, std::int32_t parameter, double most_uneven) const {
        static_cast<void>(most_uneven);
        return {.step = step, .parameter = parameter};
    }
    /// shares() of an epoch's steps.
    virtual std::vector<LookShare> shares_in(const Epoch& epoch, std::span<const std::int32_t> states) const {
        static_cast<void>(epoch);
        return shares(states);
    }

    /// Where cells only draw from nested thresholds: the patterns by rising threshold, each as often as its
    /// threshold is. In every aligned block of cells the number of those below a threshold is then right
    /// within one, which bounds a mean with certainty. Empty: nothing is known.
    virtual std::vector<std::int32_t> nested_patterns() const { return {}; }

    /// Cells come again after so many, a power of two, along x and along y. 0: nothing is known.
    virtual std::int64_t period() const noexcept { return 0; }

    virtual std::size_t memory_bytes() const noexcept = 0;
};

}  // namespace tessera
