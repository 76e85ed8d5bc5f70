#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "server/blocks/animation_op.h"
#include "server/blocks/cell_schedule.h"
#include "server/blocks/compilation.h"

namespace tessera {

/// Some of pattern, turn and scale that draw together, and what they give for each joint state of their
/// draws.
class LookGroup {
  public:
    /// Of what cells draw, as much as a program counts. More is never enumerated.
    static constexpr std::uint64_t max_states = std::uint64_t{1} << 20;

    /// Draws of one stream at one corner; or the frames that something else than the clock drives. Each
    /// alternative is a state.
    struct Draws {
        CellDraw draw;  ///< One of those.
        int dx = 0, dy = 0;
        const DrivenOp* driven = nullptr;
        std::vector<std::pair<std::uint32_t, std::uint32_t>>
            starts;  ///< Fractions k/n at which states begin: state s draws ⌊starts[s]·count⌋, exactly.
        std::vector<double> weights;      ///< Of the states; their sum is 1.
        std::vector<std::size_t> leaves;  ///< Of the schedule.
        bool only_phases = false;         ///< Nothing but the phases of the animation depends on them.

        bool typed() const noexcept { return draw.generator == proto::Draw::typed; }
        bool same(const Draws& other) const noexcept;
        std::uint64_t states() const noexcept { return weights.size(); }
    };

    /// Which draws are enumerated, and at which step or under which setting.
    struct Enumeration {
        bool phases = true, others = true;
        Step step = 0;
        Validity* validity = nullptr;
        bool by_setting = false;
        std::size_t setting = 0;
        std::int32_t frame = 0;
        bool all_driven = false;     ///< All frames that are driven, …
        std::int32_t parameter = 0;  ///< … or that of this parameter, far from targets.

        bool counts(const Draws& draws) const noexcept {
            if (draws.driven != nullptr) return all_driven;
            return draws.only_phases ? phases : others;
        }
    };

    /// Pattern, turn (steps) and scale (steps) of one joint state; those of other groups are 0.
    using Values = std::array<std::int32_t, 3>;
    using Visit = std::function<void(const Values&, double weight, const Cycle&)>;

    /// `roots`: the nodes of pattern, turn and scale. `parts`: which of them, 0 to 2.
    LookGroup(std::shared_ptr<const std::vector<CellNode>> nodes, const std::array<std::size_t, 3>& roots,
              std::span<const int> parts, const LookSteps& steps);

    /// Where the animation is a node of the group: notes what depends on nothing but its phases. `phase`,
    /// `shown`: whether a node is read as a phase, and in any other way. True if phases and the rest draw
    /// apart.
    bool find_phases(std::size_t animation, const std::vector<bool>& phase, const std::vector<bool>& shown);

    bool shares_draws_with(const LookGroup& other) const noexcept;
    bool moves() const noexcept { return moves_; }  ///< It shows the animation.
    std::span<const Draws> draws() const noexcept { return draws_; }
    std::span<const CellSchedule::Leaf> leaves() const noexcept { return schedule_.leaves(); }
    std::span<const int> parts() const noexcept { return parts_; }
    /// Joint states; some number above max_states if there are more.
    std::uint64_t states() const noexcept { return states_; }
    std::uint64_t states(const Enumeration& what) const noexcept;

    /// Runs the group for each joint state, the first draws' fastest. Draws that are not enumerated are as
    /// their first state. `map_states`: of the map, if there is one, at each corner that cells look at.
    void for_states(std::span<const std::int32_t> map_states, const Enumeration& what,
                    const Visit& visit) const;

  private:
    void add_draw(std::size_t leaf);
    void find_states(Draws& draws) const;
    std::vector<std::int32_t> drawn_by_type(const Draws& draws, std::size_t leaf) const;

    std::shared_ptr<const std::vector<CellNode>> nodes_;
    std::array<std::size_t, 3> roots_;
    std::vector<int> parts_;
    LookSteps steps_;
    CellSchedule schedule_;
    std::vector<Draws> draws_;
    std::vector<std::size_t> map_leaves_;
    std::uint64_t states_ = 1;
    bool moves_ = false;
};

}  // namespace tessera
