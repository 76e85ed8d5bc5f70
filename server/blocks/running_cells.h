#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "server/blocks/animation_op.h"
#include "server/blocks/mapped_cycles.h"
#include "server/blocks/scroll_interval.h"

namespace tessera {

/// The cells of a texture that scrolls: how long places of them show the same. What is known of its map is
/// worked out when it is first asked for.
class RunningCells {
  public:
    /// All that cells in entries of a value may show under a setting of their animation; none where that is
    /// not known.
    using LooksOf = std::function<std::vector<Look>(std::int32_t value, std::size_t setting)>;
    /// What cells show that differ by their frames alone: `look`, with the frame's pattern.
    struct Framed {
        MappedCycles cycles;
        Look look;
    };
    /// `varying`: the program's, if steps and entries and draws are all that decides. `animation`: the only
    /// one there is, if any; lives longer. `only_map`: entries alone decide. `framed`: if that is what cells
    /// are.
    RunningCells(const Scroll& scroll, const std::optional<VaryingMap>& varying, const AnimationOp* animation,
                 LooksOf looks_of, bool only_map, std::optional<Framed> framed);

    /// Asks cells as StandingCells::ask().
    using Ask =
        std::function<void(std::span<const CellAt> cells, std::span<Look> looks, std::span<Validity> frames)>;
    /// As CellProgram's.
    Validity through_shifts(const CellBlock& block, const SeenCells& seen, const Validity& frames,
                            const Ask& ask) const;
    Validity through_map(const CellBlock& block) const;

    std::size_t memory_bytes() const noexcept;  ///< At most.

  private:
    class Cells;
    /// Entries of one kind, as cells are compared.
    struct Kinds {
        std::shared_ptr<const StillRuns> runs;
        std::vector<Look> looks;  ///< By kind.
    };
    /// Under some settings; or of values, as they are. Most tell the same kinds apart, and share their runs.
    struct Known {
        std::size_t first = 0, last = 0;
        bool values = false;
        std::vector<StillRuns::Kind> kind_of_value;
        std::shared_ptr<const Kinds> kinds;
    };
    static constexpr std::size_t most_known = 16;
    /// Of each value what cells in entries of it show, if that is one look and no other.
    using SingleLooks = std::vector<std::optional<Look>>;
    const SingleLooks& looks_under(std::size_t setting) const;
    std::optional<Look> look_of(const Known& known, std::size_t value) const;
    std::shared_ptr<const Kinds> find(std::size_t first, std::size_t last, bool values) const;
    std::shared_ptr<const Kinds> make(Known& known) const;

    Scroll scroll_;
    std::shared_ptr<const StoredMap> map_;  ///< Null where there is none, or it is of too many values.
    bool drawn_ = false;                    ///< Cells draw among entries.
    std::int64_t comes_again_ = 0;          ///< As StandingCells'.
    const AnimationOp* animation_;
    LooksOf looks_of_;
    std::optional<Framed> framed_;
    mutable std::mutex mutex_;
    mutable std::list<Known> known_;  ///< Last used first.
    /// By setting, once asked for; of settings that are alike, the first.
    mutable std::vector<std::optional<SingleLooks>> looks_;
    std::vector<std::int32_t> values_;  ///< Of the map.
};

}  // namespace tessera
