#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "server/blocks/cell_program.h"
#include "server/blocks/compilation.h"
#include "server/blocks/look_group.h"

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

  private:
    struct Outcome {
        LookGroup::Values values;
        double share;
    };
    /// What the leaves of all groups say of how much is known.
    struct Known {
        bool typed = false, drawn = false;  ///< Some draws are typed, some are not.
        bool other = false;                 ///< Nothing is sure.
    };
    void join_groups();
    Known look_at_leaves();
    bool too_many_to_count() const;
    bool find_animation();
    double uneven_at(const LookGroup& group, std::size_t setting) const;
    std::vector<Outcome> enumerate(const LookGroup& group, std::span<const std::int32_t> states,
                                   const Epoch* epoch) const;
    std::vector<LookShare> shares(std::span<const std::int32_t> states, const Epoch* epoch) const;
    /// The animated group's, for each state that the map can have.
    template <class Visit>
    void for_map_states(const Visit& visit) const;

    std::array<std::size_t, 3> roots_;
    LookSteps steps_;
    std::shared_ptr<const std::vector<CellNode>> nodes_;
    std::vector<LookGroup> groups_;
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
