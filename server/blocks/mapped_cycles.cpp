#include "server/blocks/mapped_cycles.h"

#include <algorithm>
#include <array>
#include <bit>

#include "server/blocks/cell_schedule.h"
#include "server/blocks/row_hash.h"

namespace tessera {

namespace {

/// From the map's least value to its greatest.
constexpr std::int64_t most_values = 1024;
static_assert(most_values <= stretch_cells);

/// The one node of a map that `from` depends on; none if it depends on anything else than its entries.
std::optional<std::size_t> only_map_of(const std::vector<CellNode>& nodes, std::size_t from) {
    std::vector<bool> needed(nodes.size(), false);
    needed[from] = true;
    std::optional<std::size_t> map;
    for (std::size_t node = from + 1; node-- > 0;) {
        if (!needed[node]) continue;
        const CellNode& is = nodes[node];
        if (is.draw || is.steps || is.driven || is.corners) return std::nullopt;
        if (is.map) {
            if (map || is.map->sampling != VaryingMap::Sampling::nearest) return std::nullopt;
            map = node;
        }
        for (const std::size_t input : is.inputs) needed[input] = true;
    }
    return map;
}

}  // namespace

std::optional<MappedCycles> MappedCycles::of(const std::vector<CellNode>& nodes, std::size_t node) {
    const CellNode& is = nodes[node];
    if (!is.animation || is.animation->frames().line.frames() < 2) return std::nullopt;
    std::optional<std::size_t> phase, map;
    for (const AnimationSetting& setting : is.animation->settings()) {
        if (setting.phase.input < 0) return std::nullopt;
        const std::size_t drawn = is.inputs[static_cast<std::size_t>(setting.phase.input)];
        if (phase.value_or(drawn) != drawn) return std::nullopt;
        phase = drawn;
        if (setting.rest.input < 0) continue;
        const auto found = only_map_of(nodes, is.inputs[static_cast<std::size_t>(setting.rest.input)]);
        if (!found || map.value_or(*found) != *found) return std::nullopt;
        map = found;
    }
    if (!map || !nodes[*phase].draw || nodes[*phase].number) return std::nullopt;
    const CellDraw& draw = *nodes[*phase].draw;
    if (draw.generator != proto::Draw::independent || draw.count < 2 || !std::has_single_bit(draw.count))
        return std::nullopt;
    const std::vector<std::int32_t> values = possible_values(*nodes[*map].map->map);
    if (std::int64_t{values.back()} - values.front() >= most_values) return std::nullopt;
    return MappedCycles{nodes, node, *phase, nodes[*map].map->map};
}

MappedCycles::MappedCycles(const std::vector<CellNode>& nodes, std::size_t node, std::size_t phase,
                           std::shared_ptr<const StoredMap> map)
    : animation_{nodes[node].animation},
      map_{std::move(map)},
      base_{nodes[phase].draw->base},
      phase_shift_{32 - std::countr_zero(nodes[phase].draw->count)},
      settings_{animation_->settings().size()} {
    const std::vector<std::int32_t> values = possible_values(*map_);
    least_ = values.front();
    // Run with each value in the place of an entry, and nothing drawn
    const CellSchedule schedule{nodes, std::array{node}, CellSchedule::Rows::corners};
    std::vector<std::int32_t> space(schedule.space(), 0);
    for (const CellSchedule::Leaf& leaf : schedule.leaves())
        if (nodes[leaf.node].map)
            std::copy(values.begin(), values.end(),
                      space.begin() + static_cast<std::ptrdiff_t>(leaf.row * CellSchedule::row_stride));
    std::vector<Cycle> cycles(values.size());
    rests_.resize(static_cast<std::size_t>(values.back() - least_ + 1) * settings_);
    for (std::size_t setting = 0; setting < settings_; ++setting) {
        const AnimationProbe probe{.setting = setting, .cycles = cycles.data()};
        std::vector<std::int32_t> run = space;
        schedule.run({.count = static_cast<std::int32_t>(values.size()), .probe = &probe}, run.data());
        for (std::size_t i = 0; i < values.size(); ++i)
            rests_[static_cast<std::size_t>(values[i] - least_) * settings_ + setting] = cycles[i].rest;
    }
}

MappedCycles::Told MappedCycles::told_of(const CellAt& cell, RowKey key) const noexcept {
    const std::int32_t value =
        map_->entry((cell.x - map_->x) >> map_->cells_log2, (cell.y - map_->y) >> map_->cells_log2);
    const auto in_part = static_cast<std::uint32_t>(cell.x & ((std::int64_t{1} << row_log2) - 1));
    const std::int64_t* rests = rests_.data() + static_cast<std::size_t>(value - least_) * settings_;
    return {cell_bits(in_part, key.first(), key.second()) >> phase_shift_, {rests, settings_}};
}

Shown MappedCycles::shown_within(const CellAt& cell, std::int64_t z, AnimationOp::Followed& followed) const {
    const Told told = told_of(cell, row_key(base_, cell.x, cell.y, z));
    return animation_->shown_within(told.phase, told.rests, cell.step, cell.within, followed);
}

MappedCycles::Rows::Rows() : keys_(rows) {}

RowKey MappedCycles::key_of(const CellAt& cell, std::int64_t z, Rows& rows) const noexcept {
    const std::int64_t part = cell.x >> row_log2;
    auto& [known, y, of, key] = rows.keys_[static_cast<std::size_t>(cell.y) % Rows::rows];
    if (!known || y != cell.y || of != part) {
        known = true, y = cell.y, of = part;
        key = row_key(base_, cell.x, cell.y, z);
    }
    return key;
}

std::size_t MappedCycles::leave_resting_out(std::span<CellAt> cells, std::int64_t z, Rows& rows,
                                            AnimationOp::Followed& followed) const {
    std::size_t left = 0;
    for (const CellAt& cell : cells) {
        const Told told = told_of(cell, key_of(cell, z, rows));
        if (!animation_->rests_within(told.phase, told.rests, cell.step, cell.within, followed))
            cells[left++] = cell;
    }
    return left;
}

}  // namespace tessera
