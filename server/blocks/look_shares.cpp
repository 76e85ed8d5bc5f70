#include "server/blocks/look_shares.h"

#include <algorithm>
#include <map>
#include <set>

#include "shared/motion/evenness.h"

namespace tessera {

namespace {

using Basis = CellProgram::Basis;

/// Whether the fraction a comes before b.
bool before(std::pair<std::uint32_t, std::uint32_t> a, std::pair<std::uint32_t, std::uint32_t> b) noexcept {
    return std::uint64_t{a.first} * b.second < std::uint64_t{b.first} * a.second;
}

}  // namespace

LookShares::LookShares(std::shared_ptr<const std::vector<CellNode>> nodes, std::size_t pattern,
                       std::size_t turn, std::size_t scale, const LookSteps& steps)
    : roots_{pattern, turn, scale}, steps_{steps}, nodes_{std::move(nodes)} {
    // Join those of the three that share a draw
    std::array<int, 3> group_of{0, 1, 2};
    std::array<Group, 3> alone{make_group(std::array{0}), make_group(std::array{1}),
                               make_group(std::array{2})};
    const auto share = [](const Group& a, const Group& b) {
        for (const Variable& v : a.variables)
            for (const Variable& w : b.variables)
                if (v.same(w.draw, w.dx, w.dy)) return true;
        return false;
    };
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < a; ++b)
            if (share(alone[static_cast<std::size_t>(a)], alone[static_cast<std::size_t>(b)])) {
                const int from = group_of[static_cast<std::size_t>(a)],
                          to = group_of[static_cast<std::size_t>(b)];
                std::replace(group_of.begin(), group_of.end(), from, to);
            }
    for (int g = 0; g < 3; ++g) {
        std::vector<int> parts;
        for (int part = 0; part < 3; ++part)
            if (group_of[static_cast<std::size_t>(part)] == g) parts.push_back(part);
        if (!parts.empty()) groups_.push_back(make_group(parts));
    }

    // What the leaves are
    bool typed = false, drawn = false, other = false, far_draws = false;
    for (const Group& group : groups_) {
        for (const CellSchedule::Leaf& leaf : group.schedule.leaves()) {
            const CellNode& node = (*nodes_)[leaf.node];
            if (node.map) {
                other |= map_ != nullptr && map_ != &node;
                other |= leaf.dx > 1 || leaf.dy > 1;
                map_ = &node;
                corners_ |= leaf.dx != 0 || leaf.dy != 0;
                continue;
            }
            if (node.driven) {
                driven_ = true;
                continue;
            }
            const Generator generator = node.draw->generator;
            typed |= generator == proto::Draw::typed;
            drawn |= generator != proto::Draw::typed;
            other |= generator == proto::Draw::sigma;  // Nothing is sure of how often sigma draws what
            independent_ &= generator == proto::Draw::independent;
            draws_at_corners_ |= leaf.dx != 0 || leaf.dy != 0;
            far_draws |= leaf.dx > 1 || leaf.dy > 1;
        }
    }
    if (map_ != nullptr) {
        // Who knows of the map's corners knows that cells share the draws at them
        independent_ &= !map_->map->nested && !far_draws && (corners_ || !draws_at_corners_);
        // A draw of the stream that dithers tells of the map's state
        for (const Group& group : groups_)
            for (const Variable& variable : group.variables)
                other |= map_->map->key != 0 && variable.draw.key == map_->map->key;
    } else {
        independent_ &= !draws_at_corners_;
    }
    other |= !find_animation() || (animated_ != nullptr && (corners_ || draws_at_corners_));
    for (const Group& group : groups_) {
        std::uint64_t states = group.states;
        if (group.moves)
            states = states_of(group, {.phases = false}) * animated_->animation->settings().size() *
                     static_cast<std::uint64_t>(animated_->animation->frames().line.frames()) / 4;
        other |= states > max_states;
    }
    std::uint64_t outcomes = 1;
    for (const Group& group : groups_) {
        std::uint64_t most = 1;
        for (int i = 0; i < group.part_count; ++i) {
            const CellNode& root =
                (*nodes_)[roots_[static_cast<std::size_t>(group.parts[static_cast<std::size_t>(i)])]];
            most = std::min(most * static_cast<std::uint64_t>(std::int64_t{root.most} - root.least + 1),
                            max_states);
        }
        outcomes *= group.moves ? most : std::min(most, group.states);
        other |= outcomes > max_states;
        outcomes = std::min(outcomes, max_states);
    }
    if (other)
        basis_ = Basis::other;
    else if (map_ != nullptr)
        basis_ = Basis::varying;
    else if (drawn)
        basis_ = Basis::stationary;
    else if (typed)
        basis_ = Basis::typed;
    if (animated_ != nullptr && !other)
        for (const Group& group : groups_)
            for (std::size_t setting = 0; group.moves && setting < animated_->animation->settings().size();
                 ++setting)
                uneven_.push_back(std::make_unique<Unevenness>());
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
    for (Group& group : groups_) {
        std::vector<bool> under(nodes_->size(), false);
        for (int part = 0; part < group.part_count; ++part)
            under[roots_[static_cast<std::size_t>(group.parts[static_cast<std::size_t>(part)])]] = true;
        for (std::size_t node = nodes_->size(); node-- > 0;)
            if (under[node])
                for (const std::size_t input : (*nodes_)[node].inputs) under[input] = true;
        group.moves = under[animated];
        for (Variable& variable : group.variables) {
            bool some = false;
            variable.only_phases = true;
            for (const std::size_t leaf : variable.leaves) {
                const std::size_t node = group.schedule.leaves()[leaf].node;
                some |= phase[node];
                variable.only_phases &= phase[node] && !shown[node];
            }
            even_phases_ &= !some || variable.only_phases;
        }
    }
    if (map_ != nullptr) {
        map_states_ = possible_values(*map_->map->map);
    }
    return animations == 1 && !at_corners[animated];
}

template <class Visit>
void LookShares::for_map_states(const Visit& visit) const {
    if (map_ == nullptr) visit(std::span<const std::int32_t>{});
    for (const std::int32_t& state : map_states_) visit(std::span{&state, 1});
}

/// Of the shares, how much may lie elsewhere at one step under a setting; 1 where nothing is sure, or it
/// would take long to find out.
double LookShares::uneven_at(const Group& group, std::size_t setting) const {
    constexpr std::uint64_t most_phases = std::uint64_t{1} << 17, most_rests = std::uint64_t{1} << 18,
                            most_both = std::uint64_t{1} << 22;
    const Enumeration of_phases{.others = false, .by_setting = true, .setting = setting},
        of_rests{.phases = false, .by_setting = true, .setting = setting};
    const std::uint64_t maps = std::max<std::uint64_t>(map_states_.size(), 1);
    if (!even_phases_ || states_of(group, of_phases) > most_phases ||
        states_of(group, of_rests) * maps > most_rests)
        return 1;
    std::vector<WeightedPhase> phases;
    for_states(group, std::span{map_states_}.first(map_ == nullptr ? 0 : 1), of_phases,
               [&](const auto&, double weight, const Cycle& cycle) {
                   phases.push_back({cycle.phase, weight});
               });
    std::set<std::int64_t> rests;
    for_map_states([&](std::span<const std::int32_t> states) {
        for_states(group, states, of_rests,
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
    const Group& group =
        *std::find_if(groups_.begin(), groups_.end(), [](const Group& g) { return g.moves; });
    const AnimationOp::Settled settled = animated_->animation->settled_at(step);
    const auto setting = static_cast<std::size_t>(std::max(settled.setting, 0));
    const auto unevenness = [&] {
        Unevenness& of = *uneven_[setting];
        std::call_once(of.found, [&] { of.share = uneven_at(group, setting); });
        return of.share;
    };
    const double uneven = settled.setting < 0 ? 1 : unevenness();
    const std::uint64_t states = states_of(group, {});
    if (uneven <= most_uneven || states > max_states)
        return {settled.holds, step, true, setting, uneven, parameter};
    Epoch now{{}, step, false, setting, 0, parameter};
    if (states * std::max<std::uint64_t>(map_states_.size(), 1) > most_told)
        now.validity = {step, add_steps(step, 1)};
    else
        for_map_states([&](std::span<const std::int32_t> of_map) {
            for_states(group, of_map, {.step = step, .validity = &now.validity},
                       [](const auto&, double, const Cycle&) {});
        });
    return now;
}

bool LookShares::Variable::same(const CellDraw& other, int x, int y) const noexcept {
    // All typed draws follow from the cell's type; one generator's draws tell nothing of another's
    return draw.generator == other.generator && (typed() || draw.key == other.key) && dx == x && dy == y;
}

LookShares::Group LookShares::make_group(std::span<const int> parts) const {
    std::vector<std::size_t> roots;
    for (const int part : parts) roots.push_back(roots_[static_cast<std::size_t>(part)]);
    Group group{{}, 0, CellSchedule{*nodes_, roots, CellSchedule::Rows::corners}, {}, {}, 1};
    for (const int part : parts) group.parts[static_cast<std::size_t>(group.part_count++)] = part;

    const auto leaves = group.schedule.leaves();
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const CellNode& node = (*nodes_)[leaves[i].node];
        if (node.map) {
            group.map_leaves.push_back(i);
            continue;
        }
        const CellDraw draw = node.driven ? CellDraw{} : *node.draw;
        auto found =
            std::find_if(group.variables.begin(), group.variables.end(), [&](const Variable& variable) {
                return variable.same(draw, leaves[i].dx, leaves[i].dy) &&
                       variable.driven == node.driven.get();
            });
        if (found == group.variables.end()) {
            group.variables.push_back({draw, leaves[i].dx, leaves[i].dy, node.driven.get(), {}, {}, {}});
            found = group.variables.end() - 1;
        }
        found->leaves.push_back(i);
    }
    for (Variable& variable : group.variables) {
        if (variable.driven != nullptr) {
            const auto frames = static_cast<std::size_t>(variable.driven->frames().line.frames());
            variable.weights.assign(frames, 1.0 / static_cast<double>(frames));
        } else if (variable.typed()) {
            variable.weights.assign(variable.draw.types, 1.0 / variable.draw.types);
        } else {
            std::vector<std::uint32_t> counts;
            for (const std::size_t leaf : variable.leaves)
                counts.push_back((*nodes_)[leaves[leaf].node].draw->count);
            std::sort(counts.begin(), counts.end());
            counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
            for (const std::uint32_t count : counts)
                for (std::uint32_t k = 0; k < count; ++k) variable.starts.emplace_back(k, count);
            std::sort(variable.starts.begin(), variable.starts.end(), before);
            variable.starts.erase(std::unique(variable.starts.begin(), variable.starts.end(),
                                              [](auto a, auto b) { return !before(a, b) && !before(b, a); }),
                                  variable.starts.end());
            for (std::size_t s = 0; s < variable.starts.size(); ++s) {
                const auto [k, n] = variable.starts[s];
                const auto [next_k, next_n] =
                    s + 1 < variable.starts.size() ? variable.starts[s + 1] : std::pair{1u, 1u};
                variable.weights.push_back(
                    static_cast<double>(std::uint64_t{next_k} * n - std::uint64_t{k} * next_n) /
                    (static_cast<double>(n) * next_n));
            }
        }
        group.states = group.states > max_states ? group.states : group.states * variable.states();
    }
    return group;
}

std::uint64_t LookShares::states_of(const Group& group, const Enumeration& what) noexcept {
    std::uint64_t states = 1;
    for (const Variable& variable : group.variables)
        if (what.counts(variable)) states = states > max_states ? states : states * variable.states();
    return states;
}

template <class Visit>
void LookShares::for_states(const Group& group, std::span<const std::int32_t> states, const Enumeration& what,
                            const Visit& visit) const {
    std::vector<std::int32_t> space(group.schedule.space());
    const auto leaves = group.schedule.leaves();
    const auto row_of = [&](std::size_t leaf) {
        return space.data() + leaves[leaf].row * CellSchedule::row_stride;
    };
    for (const std::size_t leaf : group.map_leaves) {
        const std::size_t state =
            corners_ ? static_cast<std::size_t>(leaves[leaf].dx + 2 * leaves[leaf].dy) : std::size_t{0};
        std::fill_n(row_of(leaf), stretch_cells, states[state]);
    }
    // What typed draws give, by type
    std::map<std::size_t, std::vector<std::int32_t>> typed_draws;
    for (const Variable& variable : group.variables) {
        if (!variable.typed()) continue;
        for (const std::size_t leaf : variable.leaves) {
            std::vector<std::int32_t>& draws = typed_draws[leaf];
            draws.resize(variable.draw.types);
            std::vector<std::uint16_t> types(stretch_cells);
            for (std::uint32_t first = 0; first < variable.draw.types; first += stretch_cells) {
                const auto count = std::min<std::uint32_t>(stretch_cells, variable.draw.types - first);
                for (std::uint32_t i = 0; i < count; ++i) types[i] = static_cast<std::uint16_t>(first + i);
                (*nodes_)[leaves[leaf].node].op->run(
                    {.count = static_cast<std::int32_t>(count), .types = types.data()}, nullptr,
                    draws.data() + first);
            }
        }
    }

    const std::uint64_t all = states_of(group, what);
    std::vector<std::uint64_t> at(group.variables.size(), 0);
    for (std::size_t v = 0; v < at.size(); ++v)
        if (const DrivenOp* driven = group.variables[v].driven; driven != nullptr && !what.all_driven)
            at[v] = static_cast<std::uint64_t>(driven->frame_at(what.parameter));
    std::vector<double> weights(stretch_cells);
    std::vector<Cycle> cycles(stretch_cells);
    const AnimationProbe probe{what.setting, what.frame, weights.data(), cycles.data()};
    for (std::uint64_t done = 0; done < all;) {
        const auto count = static_cast<std::int32_t>(std::min<std::uint64_t>(stretch_cells, all - done));
        for (std::int32_t i = 0; i < count; ++i) {
            double weight = 1;
            for (std::size_t v = 0; v < group.variables.size(); ++v) {
                const Variable& variable = group.variables[v];
                if (what.counts(variable)) weight *= variable.weights[at[v]];
                for (const std::size_t leaf : variable.leaves)
                    row_of(leaf)[i] =
                        variable.driven != nullptr ? variable.driven->frames().patterns[at[v]]
                        : variable.typed()
                            ? typed_draws[leaf][at[v]]
                            : static_cast<std::int32_t>(std::uint64_t{variable.starts[at[v]].first} *
                                                        (*nodes_)[leaves[leaf].node].draw->count /
                                                        variable.starts[at[v]].second);
            }
            weights[static_cast<std::size_t>(i)] = weight;
            for (std::size_t v = 0; v < at.size(); ++v) {
                if (!what.counts(group.variables[v])) continue;
                if (++at[v] < group.variables[v].states()) break;
                at[v] = 0;
            }
        }
        group.schedule.run({.step = what.step,
                            .count = count,
                            .validity = what.validity,
                            .probe = what.by_setting ? &probe : nullptr},
                           space.data());
        for (std::int32_t i = 0; i < count; ++i) {
            std::array<std::int32_t, 3> values{};
            for (std::size_t part = 0; part < static_cast<std::size_t>(group.part_count); ++part) {
                const std::int32_t value = group.schedule.root(part, space.data())[i];
                const int which = group.parts[part];
                values[static_cast<std::size_t>(which)] = which == 0   ? value
                                                          : which == 1 ? steps_.turn(value)
                                                                       : steps_.scale(value);
            }
            visit(values, weights[static_cast<std::size_t>(i)], cycles[static_cast<std::size_t>(i)]);
        }
        done += static_cast<std::uint64_t>(count);
    }
}

std::vector<LookShares::Outcome> LookShares::enumerate(const Group& group,
                                                       std::span<const std::int32_t> states,
                                                       const Epoch* epoch) const {
    std::map<std::array<std::int32_t, 3>, double> sums;
    const auto add = [&](const std::array<std::int32_t, 3>& values, double weight, const Cycle&) {
        sums[values] += weight;
    };
    const bool all_driven = epoch == nullptr;
    const std::int32_t parameter = epoch != nullptr ? epoch->parameter : 0;
    if (!group.moves) {
        for_states(group, states, {.all_driven = all_driven, .parameter = parameter}, add);
    } else if (epoch != nullptr && !epoch->average) {
        for_states(group, states, {.step = epoch->step, .parameter = parameter}, add);
    } else {
        const AnimationOp& animation = *animated_->animation;
        const std::size_t first = epoch != nullptr ? epoch->setting : 0,
                          last = epoch != nullptr ? epoch->setting : animation.settings().size() - 1;
        for (std::size_t setting = first; setting <= last; ++setting)
            for (std::int32_t frame = 0; frame < animation.frames().line.frames(); ++frame)
                for_states(group, states,
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
    const Group* nested = nullptr;
    for (const Group& group : groups_) {
        if (group.variables.empty()) continue;
        if (group.part_count != 1 || group.parts[0] != 0 || group.variables.size() != 1) return {};
        nested = &group;
    }
    if (nested == nullptr) return {};
    for (const CellSchedule::Leaf& leaf : nested->schedule.leaves())
        if ((*nodes_)[leaf.node].draw->generator != proto::Draw::nested || leaf.dx != 0 || leaf.dy != 0)
            return {};
    std::vector<std::int32_t> patterns;
    for_states(*nested, {}, {}, [&](const std::array<std::int32_t, 3>& values, double, const Cycle&) {
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
    for (const Group& group : groups_) {
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
