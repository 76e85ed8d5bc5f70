#include "server/blocks/look_shares.h"

#include <algorithm>
#include <map>
#include <set>

#include "shared/motion/evenness.h"

namespace tessera {

namespace {

using Basis = CellProgram::Basis;

}  // namespace

LookShares::LookShares(std::shared_ptr<const std::vector<CellNode>> nodes, std::size_t pattern,
                       std::size_t turn, std::size_t scale, const LookSteps& steps)
    : roots_{pattern, turn, scale}, steps_{steps}, nodes_{std::move(nodes)} {
    join_groups();
    Known known = look_at_leaves();
    known.other |= !find_animation() || (animated_ != nullptr && (corners_ || draws_at_corners_));
    known.other |= too_many_to_count();
    if (known.other)
        basis_ = Basis::other;
    else if (map_ != nullptr)
        basis_ = Basis::varying;
    else if (known.drawn)
        basis_ = Basis::stationary;
    else if (known.typed)
        basis_ = Basis::typed;
    if (animated_ != nullptr && !known.other)
        for (const LookGroup& group : groups_)
            for (std::size_t setting = 0; group.moves() && setting < animated_->animation->settings().size();
                 ++setting)
                uneven_.push_back(std::make_unique<Unevenness>());
}

/// Those of the three that share a draw are enumerated together.
void LookShares::join_groups() {
    std::array<int, 3> group_of{0, 1, 2};
    std::vector<LookGroup> alone;
    for (int part = 0; part < 3; ++part) alone.emplace_back(nodes_, roots_, std::array{part}, steps_);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < a; ++b)
            if (alone[a].shares_draws_with(alone[b])) {
                const int from = group_of[a], to = group_of[b];
                std::replace(group_of.begin(), group_of.end(), from, to);
            }
    for (int group = 0; group < 3; ++group) {
        std::vector<int> parts;
        for (int part = 0; part < 3; ++part)
            if (group_of[static_cast<std::size_t>(part)] == group) parts.push_back(part);
        if (!parts.empty()) groups_.emplace_back(nodes_, roots_, parts, steps_);
    }
}

/// Notes the map, what is driven, and whether cells are independent.
LookShares::Known LookShares::look_at_leaves() {
    Known known;
    bool far_draws = false;
    for (const LookGroup& group : groups_) {
        for (const CellSchedule::Leaf& leaf : group.leaves()) {
            const CellNode& node = (*nodes_)[leaf.node];
            const bool at_corner = leaf.dx != 0 || leaf.dy != 0, far = leaf.dx > 1 || leaf.dy > 1;
            if (node.map) {
                known.other |= far || (map_ != nullptr && map_ != &node);
                map_ = &node;
                corners_ |= at_corner;
                continue;
            }
            if (node.driven) {
                driven_ = true;
                continue;
            }
            const Generator generator = node.draw->generator;
            known.typed |= generator == proto::Draw::typed;
            known.drawn |= generator != proto::Draw::typed;
            known.other |= generator == proto::Draw::sigma;  // Nobody knows how often sigma draws what
            independent_ &= generator == proto::Draw::independent;
            draws_at_corners_ |= at_corner;
            far_draws |= far;
        }
    }
    if (map_ == nullptr) {
        independent_ &= !draws_at_corners_;
        return known;
    }
    // Who knows of the map's corners knows that cells share the draws at them
    independent_ &= !map_->map->nested && !far_draws && (corners_ || !draws_at_corners_);
    // A draw of the stream that dithers tells of the map's state
    for (const LookGroup& group : groups_)
        for (const LookGroup::Draws& draws : group.draws())
            known.other |= map_->map->key != 0 && draws.draw.key == map_->map->key;
    return known;
}

/// Whether a group has more joint states, or all groups more outcomes, than are ever enumerated.
bool LookShares::too_many_to_count() const {
    constexpr std::uint64_t limit = LookGroup::max_states;
    std::uint64_t outcomes = 1;
    for (const LookGroup& group : groups_) {
        std::uint64_t states = group.states();
        if (group.moves())
            states = group.states({.phases = false}) * animated_->animation->settings().size() *
                     static_cast<std::uint64_t>(animated_->animation->frames().line.frames()) / 4;
        if (states > limit) return true;
        std::uint64_t most = 1;
        for (const int part : group.parts()) {
            const CellNode& root = (*nodes_)[roots_[static_cast<std::size_t>(part)]];
            most =
                std::min(most * static_cast<std::uint64_t>(std::int64_t{root.most} - root.least + 1), limit);
        }
        outcomes *= group.moves() ? most : std::min(most, group.states());
        if (outcomes > limit) return true;
    }
    return false;
}

/// Finds which animation is shown, if any, and what depends on its phases alone. False if only cells
/// themselves tell: there are several, or neighbours see it.
bool LookShares::find_animation() {
    std::vector<bool> shown(nodes_->size(), false), at_corners(nodes_->size(), false);
    for (const std::size_t root : roots_) shown[root] = true;
    std::size_t animated = nodes_->size();
    int animations = 0;
    std::vector<std::size_t> phases;
    for (std::size_t node = nodes_->size(); node-- > 0;) {
        if (!shown[node]) continue;
        const CellNode& user = (*nodes_)[node];
        std::vector<bool> only_phase(user.inputs.size(), false);
        if (user.animation) {
            ++animations;
            animated = node;
            only_phase.assign(user.inputs.size(), true);
            for (const AnimationSetting& setting : user.animation->settings()) {
                if (setting.rest.input >= 0) only_phase[static_cast<std::size_t>(setting.rest.input)] = false;
                if (setting.phase.input >= 0)
                    phases.push_back(user.inputs[static_cast<std::size_t>(setting.phase.input)]);
            }
        }
        for (std::size_t i = 0; i < user.inputs.size(); ++i) {
            if (at_corners[node] || (user.corners && i == 0)) at_corners[user.inputs[i]] = true;
            if (!only_phase[i]) shown[user.inputs[i]] = true;
        }
    }
    if (animations == 0) return true;
    animated_ = &(*nodes_)[animated];
    std::vector<bool> phase(nodes_->size(), false);
    for (const std::size_t node : phases) phase[node] = true;
    even_phases_ = true;
    for (std::size_t node = nodes_->size(); node-- > 0;) {
        if (!phase[node]) continue;
        even_phases_ &= !(*nodes_)[node].map;
        for (const std::size_t input : (*nodes_)[node].inputs) phase[input] = true;
    }
    for (LookGroup& group : groups_) even_phases_ &= group.find_phases(animated, phase, shown);
    if (map_ != nullptr) map_states_ = possible_values(*map_->map->map);
    return animations == 1 && !at_corners[animated];
}

template <class Visit>
void LookShares::for_map_states(const Visit& visit) const {
    if (map_ == nullptr) visit(std::span<const std::int32_t>{});
    for (const std::int32_t& state : map_states_) visit(std::span{&state, 1});
}

/// Of the shares, how much may lie elsewhere at one step under a setting; 1 where nothing is sure, or it
/// would take long to find out.
double LookShares::uneven_at(const LookGroup& group, std::size_t setting) const {
    constexpr std::uint64_t most_phases = std::uint64_t{1} << 17, most_rests = std::uint64_t{1} << 18,
                            most_both = std::uint64_t{1} << 22;
    const LookGroup::Enumeration of_phases{.others = false, .by_setting = true, .setting = setting},
        of_rests{.phases = false, .by_setting = true, .setting = setting};
    const std::uint64_t maps = std::max<std::uint64_t>(map_states_.size(), 1);
    if (!even_phases_ || group.states(of_phases) > most_phases || group.states(of_rests) * maps > most_rests)
        return 1;
    std::vector<WeightedPhase> phases;
    group.for_states(std::span{map_states_}.first(map_ == nullptr ? 0 : 1), of_phases,
                     [&](const auto&, double weight, const Cycle& cycle) {
                         phases.push_back({cycle.phase, weight});
                     });
    std::set<std::int64_t> rests;
    for_map_states([&](std::span<const std::int32_t> states) {
        group.for_states(states, of_rests,
                         [&](const auto&, double, const Cycle& cycle) { rests.insert(cycle.rest); });
    });
    if (phases.size() * rests.size() > most_both) return 1;
    double most = 0;
    for (const std::int64_t rest : rests)
        most = std::max(most, uneven_frames(animated_->animation->frames().line, rest, phases));
    return most;
}

Epoch LookShares::epoch(Step step, std::int32_t parameter, double most_uneven) const {
    if (uneven_.empty()) return {.step = step, .parameter = parameter};
    constexpr std::uint64_t most_told = std::uint64_t{1} << 16;
    const LookGroup& group =
        *std::find_if(groups_.begin(), groups_.end(), [](const LookGroup& g) { return g.moves(); });
    const AnimationOp::Settled settled = animated_->animation->settled_at(step);
    const auto setting = static_cast<std::size_t>(std::max(settled.setting, 0));
    const auto unevenness = [&] {
        Unevenness& of = *uneven_[setting];
        std::call_once(of.found, [&] { of.share = uneven_at(group, setting); });
        return of.share;
    };
    const double uneven = settled.setting < 0 ? 1 : unevenness();
    const std::uint64_t states = group.states({});
    if (uneven <= most_uneven || states > LookGroup::max_states)
        return {settled.holds, step, true, setting, uneven, parameter};
    Epoch now{{}, step, false, setting, 0, parameter};
    if (states * std::max<std::uint64_t>(map_states_.size(), 1) > most_told)
        now.validity = {step, add_steps(step, 1)};
    else
        for_map_states([&](std::span<const std::int32_t> of_map) {
            group.for_states(of_map, {.step = step, .validity = &now.validity},
                             [](const auto&, double, const Cycle&) {});
        });
    return now;
}

std::vector<LookShares::Outcome> LookShares::enumerate(const LookGroup& group,
                                                       std::span<const std::int32_t> states,
                                                       const Epoch* epoch) const {
    std::map<LookGroup::Values, double> sums;
    const auto add = [&](const LookGroup::Values& values, double weight, const Cycle&) {
        sums[values] += weight;
    };
    const bool all_driven = epoch == nullptr;
    const std::int32_t parameter = epoch != nullptr ? epoch->parameter : 0;
    if (!group.moves()) {
        group.for_states(states, {.all_driven = all_driven, .parameter = parameter}, add);
    } else if (epoch != nullptr && !epoch->average) {
        group.for_states(states, {.step = epoch->step, .parameter = parameter}, add);
    } else {
        const AnimationOp& animation = *animated_->animation;
        const std::size_t first = epoch != nullptr ? epoch->setting : 0,
                          last = epoch != nullptr ? epoch->setting : animation.settings().size() - 1;
        for (std::size_t setting = first; setting <= last; ++setting)
            for (std::int32_t frame = 0; frame < animation.frames().line.frames(); ++frame)
                group.for_states(states,
                                 {.phases = false,
                                  .by_setting = true,
                                  .setting = setting,
                                  .frame = frame,
                                  .all_driven = all_driven,
                                  .parameter = parameter},
                                 add);
    }
    double total = 0;
    for (const auto& [values, share] : sums) total += share;
    std::vector<Outcome> outcomes;
    for (const auto& [values, share] : sums) outcomes.push_back({values, share / total});
    return outcomes;
}

std::optional<VaryingMap> LookShares::varying() const {
    if (basis_ != Basis::varying) return std::nullopt;
    return VaryingMap{map_->map->map.get(), map_->map->sampling, corners_, map_->map->nested,
                      draws_at_corners_};
}

std::vector<std::int32_t> LookShares::nested_patterns() const {
    if (basis_ != Basis::stationary || animated_ != nullptr || driven_) return {};
    const LookGroup* nested = nullptr;
    for (const LookGroup& group : groups_) {
        if (group.draws().empty()) continue;
        if (group.parts().size() != 1 || group.parts()[0] != 0 || group.draws().size() != 1) return {};
        nested = &group;
    }
    if (nested == nullptr) return {};
    for (const CellSchedule::Leaf& leaf : nested->leaves())
        if ((*nodes_)[leaf.node].draw->generator != proto::Draw::nested || leaf.dx != 0 || leaf.dy != 0)
            return {};
    std::vector<std::int32_t> patterns;
    nested->for_states({}, {}, [&](const LookGroup::Values& values, double, const Cycle&) {
        patterns.push_back(values[0]);
    });
    return patterns;
}

std::vector<LookShare> LookShares::shares(std::span<const std::int32_t> states) const {
    return shares(states, nullptr);
}

std::vector<LookShare> LookShares::shares(std::span<const std::int32_t> states, const Epoch& epoch) const {
    return shares(states, animated_ == nullptr && !driven_ ? nullptr : &epoch);
}

std::vector<LookShare> LookShares::shares(std::span<const std::int32_t> states, const Epoch* epoch) const {
    const std::size_t needed = map_ == nullptr ? 0 : corners_ ? 4 : 1;
    if (basis_ == Basis::other || states.size() < needed) return {};
    std::vector<Outcome> all{{{0, 0, 0}, 1.0}};
    for (const LookGroup& group : groups_) {
        const std::vector<Outcome> more = enumerate(group, states, epoch);
        std::vector<Outcome> joined;
        joined.reserve(all.size() * more.size());
        for (const Outcome& a : all)
            for (const Outcome& b : more) {
                Outcome both{a.values, a.share * b.share};
                for (std::size_t i = 0; i < 3; ++i) both.values[i] += b.values[i];
                joined.push_back(both);
            }
        all = std::move(joined);
    }
    std::vector<LookShare> shares;
    for (const Outcome& outcome : all)
        shares.push_back({outcome.values[0], static_cast<std::uint8_t>(outcome.values[1]),
                          static_cast<std::uint8_t>(outcome.values[2]), outcome.share});
    return shares;
}

}  // namespace tessera
