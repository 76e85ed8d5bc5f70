#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "tests/support/made_patterns.h"

namespace tessera {

/// Cells whose looks one map shifts, written as plainly as may be: what expectations are held against.
struct MadeAreas {
    StoredMap map;
    VaryingMap::Sampling sampling = VaryingMap::Sampling::nearest;
    bool corners = false;
    std::uint64_t seed = 1;
    /// The patterns that states ask for, each as often as the others.
    std::function<std::vector<std::int32_t>(std::span<const std::int32_t>)> choice_of;

    struct Weighted {
        std::int32_t state;
        double weight;
    };
    /// The states that cell (x, y) may draw.
    std::vector<Weighted> states_at(std::int64_t x, std::int64_t y) const {
        using Sampling = VaryingMap::Sampling;
        const std::int64_t side = std::int64_t{1} << map.cells_log2;
        const std::int64_t i = (x - map.x) >> map.cells_log2, j = (y - map.y) >> map.cells_log2;
        double right = static_cast<double>((x - map.x) & (side - 1)) / static_cast<double>(side);
        double down = static_cast<double>((y - map.y) & (side - 1)) / static_cast<double>(side);
        if (sampling == Sampling::nearest || sampling == Sampling::dithered_y) right = 0;
        if (sampling == Sampling::nearest || sampling == Sampling::dithered_x) down = 0;
        return {{map.entry(i, j), (1 - right) * (1 - down)},
                {map.entry(i + 1, j), right * (1 - down)},
                {map.entry(i, j + 1), (1 - right) * down},
                {map.entry(i + 1, j + 1), right * down}};
    }
    std::int32_t draw_state(std::int64_t x, std::int64_t y) const {
        double rest = static_cast<double>(hash(seed, stream("state"), x, y) >> 11) / 9007199254740992.0;
        const auto states = states_at(x, y);
        for (const Weighted& state : states)
            if ((rest -= state.weight) < 0) return state.state;
        return states[0].state;
    }
    std::int32_t pattern(std::int64_t x, std::int64_t y) const {
        std::vector<std::int32_t> states{draw_state(x, y)};
        if (corners)
            states = {states[0], draw_state(x + 1, y), draw_state(x, y + 1), draw_state(x + 1, y + 1)};
        const auto choice = choice_of(states);
        return choice[uniform_below(hash(seed, stream("choice"), x, y),
                                    static_cast<std::uint32_t>(choice.size()))];
    }
    std::vector<LookShare> shares(std::span<const std::int32_t> states) const {
        std::vector<LookShare> shares;
        const auto choice = choice_of(states);
        for (const std::int32_t pattern : choice)
            shares.push_back({pattern, 0, 0, 1.0 / static_cast<double>(choice.size())});
        return shares;
    }

    /// The expectation of one cell, over all combinations of what its corners may draw.
    std::array<double, 4> expected_cell(std::int64_t x, std::int64_t y,
                                        const std::vector<std::array<double, 4>>& means) const {
        std::array<double, 4> sum{};
        const auto add = [&](std::span<const std::int32_t> states, double weight) {
            for (const LookShare& share : shares(states))
                for (std::size_t c = 0; c < 4 && share.pattern >= 0; ++c)
                    sum[c] += weight * share.share * means[static_cast<std::size_t>(share.pattern)][c];
        };
        if (!corners) {
            for (const Weighted& state : states_at(x, y)) add({&state.state, 1}, state.weight);
            return sum;
        }
        const auto a = states_at(x, y), b = states_at(x + 1, y), c = states_at(x, y + 1),
                   d = states_at(x + 1, y + 1);
        for (int i = 0; i < 256; ++i) {
            const auto pick = [&](const std::vector<Weighted>& of, int corner) {
                return of[static_cast<std::size_t>(i >> 2 * corner & 3)];
            };
            const std::array<std::int32_t, 4> states{pick(a, 0).state, pick(b, 1).state, pick(c, 2).state,
                                                     pick(d, 3).state};
            const double weight =
                pick(a, 0).weight * pick(b, 1).weight * pick(c, 2).weight * pick(d, 3).weight;
            if (weight > 0) add(states, weight);
        }
        return sum;
    }
};

/// A map of random states below `states`.
inline StoredMap made_map(std::int32_t width, std::int32_t height, std::int32_t states, StoredMap::Edge edge,
                          int cells_log2, std::int64_t x = 0, std::int64_t y = 0) {
    std::vector<std::int32_t> values;
    for (std::int32_t i = 0; i < width * height; ++i)
        values.push_back(
            static_cast<std::int32_t>(hash(5, stream("map"), i, 0) % static_cast<unsigned>(states)));
    return StoredMap{width, height, values, edge, cells_log2, x << cells_log2, y << cells_log2};
}

/// A plan of one-texel cells (or of larger ones) that shows `areas`, which lives as long.
inline ReferencePlan made_area_plan(const MadeAreas& areas, PatternImages images) {
    auto program = std::make_shared<MadeProgram>();
    program->made_basis = CellProgram::Basis::varying;
    program->map = VaryingMap{&areas.map, areas.sampling, areas.corners, false};
    program->pattern_of = [&areas](std::int64_t x, std::int64_t y, std::int64_t, std::uint16_t) {
        return areas.pattern(x, y);
    };
    program->shares_of = [&areas](std::span<const std::int32_t> states) { return areas.shares(states); };
    int log2 = 0;
    while (std::int32_t{1} << log2 < images.side) ++log2;
    return {made_grid(log2), std::make_shared<const PatternImages>(std::move(images)), program, nullptr};
}

}  // namespace tessera
