#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "server/blocks/cell_program.h"
#include "server/blocks/cell_schedule.h"
#include "server/blocks/compilation.h"

namespace tessera {

/// How often cells show what: enumerates the draws that pattern, turn and scale depend on. Those that two of
/// them share are enumerated together, others apart.
class LookShares {
  public:
    /// `pattern`, `turn`, `scale`: nodes.
    LookShares(std::shared_ptr<const std::vector<CellNode>> nodes, std::size_t pattern, std::size_t turn,
               std::size_t scale, const LookSteps& steps);

    CellProgram::Basis basis() const noexcept { return basis_; }  ///< Of pattern, turn and scale only.
    bool independent_cells() const noexcept { return independent_; }
    std::optional<VaryingMap> varying() const;
    std::vector<LookShare> shares(std::span<const std::int32_t> states) const;

    /// As CellProgram's.
    Epoch epoch(Step step, std::int32_t parameter, double most_uneven) const;
    std::vector<LookShare> shares(std::span<const std::int32_t> states, const Epoch& epoch) const;

    /// As CellProgram::nested_patterns().
    std::vector<std::int32_t> nested_patterns() const;

    static constexpr std::uint64_t max_states = std::uint64_t{1} << 20;

  private:
    /// Draws of one stream at one corner; or the frames that something else than the clock drives, each as a
    /// state. State s draws ⌊places[s]·count⌋, exactly: see draw_at.
    struct Variable {
        CellDraw draw;  ///< One of those.
        int dx = 0, dy = 0;
        const DrivenOp* driven = nullptr;
        bool typed() const noexcept { return draw.generator == proto::Draw::typed; }
        bool same(const CellDraw& other, int x, int y) const noexcept;
        std::vector<std::pair<std::uint32_t, std::uint32_t>>
            starts;  ///< Fractions k/n at which states begin.
        std::vector<double> weights;
        std::vector<std::size_t> leaves;  ///< Of the group's schedule.
        bool only_phases = false;         ///< Nothing but the phases of the animation depends on it.
        std::uint64_t states() const noexcept { return weights.size(); }
    };
    /// Some of pattern, turn and scale that draw together.
    struct Group {
        std::array<int, 3> parts{};  ///< 0 pattern, 1 turn, 2 scale
        int part_count = 0;
        CellSchedule schedule;
        std::vector<Variable> variables;
        std::vector<std::size_t> map_leaves;
        std::uint64_t states = 1;
        bool moves = false;
    };
    /// Which draws of a group are enumerated, and at which step or under which setting.
    struct Enumeration {
        bool phases = true, others = true;
        Step step = 0;
        Validity* validity = nullptr;
        bool by_setting = false;
        std::size_t setting = 0;
        std::int32_t frame = 0;
        bool all_driven = false;     ///< All frames that are driven, …
        std::int32_t parameter = 0;  ///< … or that of this parameter, far from targets.
        bool counts(const Variable& variable) const noexcept {
            if (variable.driven != nullptr) return all_driven;
            return variable.only_phases ? phases : others;
        }
    };
    struct Outcome {
        std::array<std::int32_t, 3> values;
        double share;
    };
    Group make_group(std::span<const int> parts) const;
    static std::uint64_t states_of(const Group& group, const Enumeration& what) noexcept;
    /// Runs the group for each joint state of its draws: `visit(values, weight, cycle)`, the first variable's
    /// states fastest. Draws that are not enumerated are as their first state.
    template <class Visit>
    void for_states(const Group& group, std::span<const std::int32_t> states, const Enumeration& what,
                    const Visit& visit) const;
    std::vector<Outcome> enumerate(const Group& group, std::span<const std::int32_t> states,
                                   const Epoch* epoch) const;
    std::vector<LookShare> shares(std::span<const std::int32_t> states, const Epoch* epoch) const;
    bool find_animation();
    double uneven_at(const Group& group, std::size_t setting) const;
    /// The animated group's, for each state that the map can have.
    template <class Visit>
    void for_map_states(const Visit& visit) const;

    std::array<std::size_t, 3> roots_;
    LookSteps steps_;
    std::shared_ptr<const std::vector<CellNode>> nodes_;
    std::vector<Group> groups_;
    CellProgram::Basis basis_ = CellProgram::Basis::constant;
    bool independent_ = true;
    const CellNode* map_ = nullptr;
    bool corners_ = false;
    bool draws_at_corners_ = false;         ///< Other than the map's.
    bool driven_ = false;                   ///< By targets or requests.
    const CellNode* animated_ = nullptr;    ///< The one animation that pattern, turn or scale depend on.
    bool even_phases_ = false;              ///< Its phases are drawn, and nothing else depends on them.
    std::vector<std::int32_t> map_states_;  ///< Where there is an animation.
    /// What uneven_at() says, found when it is first asked for: most settings are never looked at.
    struct Unevenness {
        std::once_flag found;
        double share = 1;
    };
    std::vector<std::unique_ptr<Unevenness>> uneven_;  ///< By setting.
};

}  // namespace tessera
