#include "server/blocks/look_group.h"

#include <algorithm>
#include <map>

namespace tessera {

namespace {

/// Whether the fraction a comes before b.
bool before(std::pair<std::uint32_t, std::uint32_t> a, std::pair<std::uint32_t, std::uint32_t> b) noexcept {
    return std::uint64_t{a.first} * b.second < std::uint64_t{b.first} * a.second;
}

std::vector<std::size_t> roots_of(const std::array<std::size_t, 3>& roots, std::span<const int> parts) {
    std::vector<std::size_t> some;
    for (const int part : parts) some.push_back(roots[static_cast<std::size_t>(part)]);
    return some;
}

}  // namespace

bool LookGroup::Draws::same(const Draws& other) const noexcept {
    // All typed draws follow from the cell's type; one generator's draws tell nothing of another's
    return draw.generator == other.draw.generator && (typed() || draw.key == other.draw.key) &&
           dx == other.dx && dy == other.dy;
}

LookGroup::LookGroup(std::shared_ptr<const std::vector<CellNode>> nodes,
                     const std::array<std::size_t, 3>& roots, std::span<const int> parts,
                     const LookSteps& steps)
    : nodes_{std::move(nodes)},
      roots_{roots},
      parts_(parts.begin(), parts.end()),
      steps_{steps},
      schedule_{*nodes_, roots_of(roots, parts), CellSchedule::Rows::corners} {
    for (std::size_t leaf = 0; leaf < leaves().size(); ++leaf) {
        if ((*nodes_)[leaves()[leaf].node].map)
            map_leaves_.push_back(leaf);
        else
            add_draw(leaf);
    }
    for (Draws& draws : draws_) {
        find_states(draws);
        states_ = states_ > max_states ? states_ : states_ * draws.states();
    }
}

void LookGroup::add_draw(std::size_t leaf) {
    const CellSchedule::Leaf& at = leaves()[leaf];
    const CellNode& node = (*nodes_)[at.node];
    Draws draws{node.driven ? CellDraw{} : *node.draw, at.dx, at.dy, node.driven.get(), {}, {}, {}};
    auto found = std::find_if(draws_.begin(), draws_.end(), [&](const Draws& known) {
        return known.same(draws) && known.driven == draws.driven;
    });
    if (found == draws_.end()) found = draws_.insert(draws_.end(), std::move(draws));
    found->leaves.push_back(leaf);
}

void LookGroup::find_states(Draws& draws) const {
    if (draws.driven != nullptr || draws.typed()) {
        const std::size_t states = draws.driven != nullptr
                                       ? static_cast<std::size_t>(draws.driven->frames().line.frames())
                                       : draws.draw.types;
        draws.weights.assign(states, 1.0 / static_cast<double>(states));
        return;
    }
    // One real number drives all: it is cut wherever one of the integers made of it changes
    std::vector<std::uint32_t> counts;
    for (const std::size_t leaf : draws.leaves) counts.push_back((*nodes_)[leaves()[leaf].node].draw->count);
    std::sort(counts.begin(), counts.end());
    counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
    for (const std::uint32_t count : counts)
        for (std::uint32_t k = 0; k < count; ++k) draws.starts.emplace_back(k, count);
    if (counts.size() > 1) std::sort(draws.starts.begin(), draws.starts.end(), before);
    draws.starts.erase(std::unique(draws.starts.begin(), draws.starts.end(),
                                   [](auto a, auto b) { return !before(a, b) && !before(b, a); }),
                       draws.starts.end());
    for (std::size_t s = 0; s < draws.starts.size(); ++s) {
        const auto [k, n] = draws.starts[s];
        const auto [next_k, next_n] = s + 1 < draws.starts.size() ? draws.starts[s + 1] : std::pair{1u, 1u};
        draws.weights.push_back(static_cast<double>(std::uint64_t{next_k} * n - std::uint64_t{k} * next_n) /
                                (static_cast<double>(n) * next_n));
    }
}

bool LookGroup::find_phases(std::size_t animation, const std::vector<bool>& phase,
                            const std::vector<bool>& shown) {
    std::vector<bool> under(nodes_->size(), false);
    for (const std::size_t root : roots_of(roots_, parts_)) under[root] = true;
    for (std::size_t node = nodes_->size(); node-- > 0;)
        if (under[node])
            for (const std::size_t input : (*nodes_)[node].inputs) under[input] = true;
    moves_ = under[animation];

    bool apart = true;
    for (Draws& draws : draws_) {
        bool some = false;
        draws.only_phases = true;
        for (const std::size_t leaf : draws.leaves) {
            const std::size_t node = leaves()[leaf].node;
            some |= phase[node];
            draws.only_phases &= phase[node] && !shown[node];
        }
        apart &= !some || draws.only_phases;
    }
    return apart;
}

bool LookGroup::shares_draws_with(const LookGroup& other) const noexcept {
    for (const Draws& mine : draws_)
        for (const Draws& theirs : other.draws_)
            if (mine.same(theirs)) return true;
    return false;
}

std::uint64_t LookGroup::states(const Enumeration& what) const noexcept {
    std::uint64_t states = 1;
    for (const Draws& draws : draws_)
        if (what.counts(draws)) states = states > max_states ? states : states * draws.states();
    return states;
}

std::vector<std::int32_t> LookGroup::drawn_by_type(const Draws& draws, std::size_t leaf) const {
    std::vector<std::int32_t> drawn(draws.draw.types);
    std::vector<std::uint16_t> types(stretch_cells);
    for (std::uint32_t first = 0; first < draws.draw.types; first += stretch_cells) {
        const auto count = std::min<std::uint32_t>(stretch_cells, draws.draw.types - first);
        for (std::uint32_t i = 0; i < count; ++i) types[i] = static_cast<std::uint16_t>(first + i);
        (*nodes_)[leaves()[leaf].node].op->run(
            {.count = static_cast<std::int32_t>(count), .types = types.data()}, nullptr,
            drawn.data() + first);
    }
    return drawn;
}

void LookGroup::for_states(std::span<const std::int32_t> map_states, const Enumeration& what,
                           const Visit& visit) const {
    std::vector<std::int32_t> space(schedule_.space());
    const auto row_of = [&](std::size_t leaf) {
        return space.data() + leaves()[leaf].row * CellSchedule::row_stride;
    };
    for (const std::size_t leaf : map_leaves_) {
        const auto corner = static_cast<std::size_t>(leaves()[leaf].dx + 2 * leaves()[leaf].dy);
        std::fill_n(row_of(leaf), stretch_cells, map_states[corner]);
    }
    std::map<std::size_t, std::vector<std::int32_t>> by_type;
    for (const Draws& draws : draws_)
        if (draws.typed())
            for (const std::size_t leaf : draws.leaves) by_type[leaf] = drawn_by_type(draws, leaf);
    const auto value_of = [&](const Draws& draws, std::size_t leaf, std::uint64_t state) {
        if (draws.driven != nullptr) return draws.driven->frames().patterns[state];
        if (draws.typed()) return by_type[leaf][state];
        const auto [k, n] = draws.starts[state];
        return static_cast<std::int32_t>(std::uint64_t{k} * (*nodes_)[leaves()[leaf].node].draw->count / n);
    };

    std::vector<std::uint64_t> at(draws_.size(), 0);
    for (std::size_t d = 0; d < at.size(); ++d)
        if (const DrivenOp* driven = draws_[d].driven; driven != nullptr && !what.all_driven)
            at[d] = static_cast<std::uint64_t>(driven->frame_at(what.parameter));
    std::vector<double> weights(stretch_cells);
    std::vector<Cycle> cycles(stretch_cells);
    const AnimationProbe probe{what.setting, what.frame, weights.data(), cycles.data()};
    const std::uint64_t all = states(what);
    for (std::uint64_t done = 0; done < all;) {
        const auto count = static_cast<std::int32_t>(std::min<std::uint64_t>(stretch_cells, all - done));
        for (std::int32_t i = 0; i < count; ++i) {
            double weight = 1;
            for (std::size_t d = 0; d < at.size(); ++d) {
                if (what.counts(draws_[d])) weight *= draws_[d].weights[at[d]];
                for (const std::size_t leaf : draws_[d].leaves)
                    row_of(leaf)[i] = value_of(draws_[d], leaf, at[d]);
            }
            weights[static_cast<std::size_t>(i)] = weight;
            for (std::size_t d = 0; d < at.size(); ++d) {
                if (!what.counts(draws_[d])) continue;
                if (++at[d] < draws_[d].states()) break;
                at[d] = 0;
            }
        }
        schedule_.run({.step = what.step,
                       .count = count,
                       .validity = what.validity,
                       .probe = what.by_setting ? &probe : nullptr},
                      space.data());
        for (std::int32_t i = 0; i < count; ++i) {
            Values values{};
            for (std::size_t part = 0; part < parts_.size(); ++part) {
                const std::int32_t value = schedule_.root(part, space.data())[i];
                const int which = parts_[part];
                values[static_cast<std::size_t>(which)] = which == 0   ? value
                                                          : which == 1 ? steps_.turn(value)
                                                                       : steps_.scale(value);
            }
            visit(values, weights[static_cast<std::size_t>(i)], cycles[static_cast<std::size_t>(i)]);
        }
        done += static_cast<std::uint64_t>(count);
    }
}

}  // namespace tessera
