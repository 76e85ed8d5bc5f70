#include "server/pattern/map_expectation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/pattern/corner_patches.h"
#include "server/pattern/look_mixture.h"
#include "server/pattern/map_bounds.h"
#include "server/pattern/map_states.h"
#include "server/pattern/patch_basis.h"
#include "server/pattern/patch_sums.h"

namespace tessera {
namespace {

constexpr double rounding_codes = 4e-5;
/// More kinds of patches than that are not listed.
constexpr std::uint32_t most_corner_patches = 1 << 14;
/// Of maps that edits change, all kinds are made, if they are no more than this.
constexpr std::size_t most_edited_patches = 1 << 12;
constexpr std::uint64_t sundry_bytes = std::uint64_t{32} << 20;
class MapExpectation final : public AreaExpectation {
  public:
    MapExpectation(const CellProgram& program, const VaryingMap& varying, MapStates states,
                   const LookMeans& means, std::int32_t slice, double uneven)
        : map_{*varying.map},
          bounds_{varying, program.independent_cells(), uneven},
          states_{std::move(states)},
          columns_{basis_of(varying.sampling, varying.corners, false)},
          rows_{basis_of(varying.sampling, varying.corners, true)},
          corners_{varying.corners},
          drawn_{varying.sampling != VaryingMap::Sampling::nearest} {
        // The first state's colours are what others are told from
        const std::array<std::int32_t, 4> first{states_.values().front(), states_.values().front(),
                                                states_.values().front(), states_.values().front()};
        const std::span<const std::int32_t> first_states{first.data(), corners_ ? 4u : 1u};
        base_ = base_of(program.shares(first_states), means, slice);
        if (corners_) {
            list_corner_patches(program, varying, means, slice);
        } else {
            for (const std::int32_t& state : states_.values()) {
                looks_.push_back(mixture_of(program.shares({&state, 1}), means, slice, base_));
                if (looks_.back().range.width() > 0) bounds_.draws_looks();
                if (!drawn_) spread_.add_entries(std::array{&looks_.back()});
            }
            if (drawn_) {
                std::vector<const LookMixture*> all;
                for (const LookMixture& looks : looks_) all.push_back(&looks);
                spread_.add_entries(all);
            }
        }
        if (is_listed()) find_whole();
    }

    /// Whether there were few enough kinds of patches.
    bool is_listed() const noexcept {
        return !corner_patches_ || corner_patches_->count() <= most_corner_patches;
    }

    ChanceBound bound(int up) const noexcept override {
        if (up < whole_up_) return bounds_.of(up, spread_);
        tables();
        return bounds_.of(up, whole_, spread_.range);
    }

    Result<Evaluation> evaluate(const TexelRegion& region, int up, const Budget& budget, LinearImage& out,
                                std::int64_t shift) const override {
        tables();
        if (up > map_.cells_log2)
            return over_patches(region, up - map_.cells_log2, up, budget, shift >> map_.cells_log2, out);
        TexelRegion moved = region;
        moved.x += shift >> up;
        return inside_patches(moved, up, budget, out);
    }

    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + states_.memory_bytes() + looks_.size() * sizeof looks_[0] +
               static_cast<std::size_t>(map_expectation_bytes(map_) - sundry_bytes) +
               (corner_patches_ ? corner_patches_->memory_bytes() : 0);
    }

  private:
    std::uint16_t state_at(std::int64_t i, std::int64_t j) const noexcept {
        return states_.number(map_.entry(i, j));
    }

    void list_corner_patches(const CellProgram& program, const VaryingMap& varying, const LookMeans& means,
                             std::int32_t slice) {
        corner_patches_.emplace(program, varying, means, slice, states_.values(), base_);
        const std::size_t kinds = states_.values().size();
        if (map_.bounded() && kinds * kinds * kinds * kinds <= most_edited_patches) {
            // All that edits may make of the map
            all_patches_ = kinds;
            for (std::size_t i = 0; i < kinds * kinds * kinds * kinds; ++i)
                corner_patches_->number({static_cast<std::uint16_t>(i % kinds),
                                         static_cast<std::uint16_t>(i / kinds % kinds),
                                         static_cast<std::uint16_t>(i / kinds / kinds % kinds),
                                         static_cast<std::uint16_t>(i / kinds / kinds / kinds)});
        } else {
            list_patches();
            if (!is_listed()) return;
        }
        corner_patches_->make();
        for (std::uint32_t patch = 0; patch < corner_patches_->count(); ++patch)
            spread_.add((*corner_patches_)[patch]);
    }
    void list_patches() const {
        const AreaSums::Axis x = patch_axis(map_, map_.width), y = patch_axis(map_, map_.height);
        patch_of_.reserve(static_cast<std::size_t>(x.count * y.count));
        for (std::int64_t j = y.from; j < y.from + y.count; ++j)
            for (std::int64_t i = x.from; i < x.from + x.count; ++i) {
                const std::array<std::uint16_t, 4> around{state_at(i, j), state_at(i + 1, j),
                                                          state_at(i, j + 1), state_at(i + 1, j + 1)};
                const std::size_t number =
                    all_patches_ == 0
                        ? corner_patches_->number(around)
                        : around[0] + all_patches_ *
                                          (around[1] + all_patches_ * (around[2] + all_patches_ * around[3]));
                patch_of_.push_back(static_cast<std::uint16_t>(number));
                if (!is_listed()) return;
            }
    }
    const CornerPatches::Patch& corner_patch(std::int64_t i, std::int64_t j) const noexcept {
        const AreaSums::Axis x = patch_axis(map_, map_.width), y = patch_axis(map_, map_.height);
        return (*corner_patches_)[patch_of_[static_cast<std::size_t>(y.stored(j) * x.count + x.stored(i))]];
    }

    /// The mean over all cells of a patch, told from base_.
    Colour patch_mean(std::int64_t i, std::int64_t j) const noexcept {
        if (corners_) return corner_patch(i, j).mean;
        const std::int64_t cells = std::int64_t{1} << map_.cells_log2;
        const auto across = means_over(columns_, 0, cells, cells), down = means_over(rows_, 0, cells, cells);
        Colour mean{};
        for (std::size_t row = 0; row < functions_of(rows_); ++row)
            for (std::size_t column = 0; column < functions_of(columns_); ++column) {
                const Colour& entry = looks_[state_at(i + static_cast<std::int64_t>(column),
                                                      j + static_cast<std::int64_t>(row))]
                                          .mean;
                for (std::size_t c = 0; c < 4; ++c) mean[c] += down[row] * across[column] * entry[c];
            }
        return mean;
    }

    /// What is made of all of the map, when it is asked for first: edits come faster than that.
    void tables() const {
        std::call_once(tabled_, [this] {
            if (corners_ && patch_of_.empty()) list_patches();
            sums_.emplace(map_, [this](std::int64_t i, std::int64_t j) { return patch_mean(i, j); });
            if (whole_up_ <= max_level) measure_whole();
        });
    }

    /// The mean over all patches of a map that repeats, for texels that hold each as often.
    void find_whole() {
        const AreaSums::Axis x = patch_axis(map_, map_.width), y = patch_axis(map_, map_.height);
        const auto width = static_cast<std::uint64_t>(x.count), height = static_cast<std::uint64_t>(y.count);
        if (x.wraps && std::has_single_bit(width) && std::has_single_bit(height))
            whole_up_ = map_.cells_log2 + std::countr_zero(std::max(width, height));
    }
    void measure_whole() const {
        const AreaSums::Axis x = patch_axis(map_, map_.width), y = patch_axis(map_, map_.height);
        const auto width = static_cast<std::uint64_t>(x.count), height = static_cast<std::uint64_t>(y.count);
        const double share = 1 / static_cast<double>(width * height);
        PatchRow patches;
        patches.top.resize(static_cast<std::size_t>(width) + 1);
        patches.bottom.resize(patches.top.size());
        for (std::int64_t j = 0; j < y.count; ++j) {
            read_row(0, j, patches);
            for (std::size_t at = 0; at + 1 < patches.top.size(); ++at) {
                MapSpread patch;
                measure(patches, at, patch);
                bounds_.add_patch(share, patch, whole_);
            }
        }
    }

    /// Patches of a row of the texture, from the `first` on: what their expectations are made of.
    struct PatchRow {
        std::vector<std::uint16_t> top, bottom;  ///< States of entries; with corners, `top` numbers patches.
    };
    void read_row(std::int64_t first, std::int64_t j, PatchRow& row) const noexcept {
        if (!corners_) {
            read_states(first, j, row.top);
            if (functions_of(rows_) > 1) read_states(first, j + 1, row.bottom);
            return;
        }
        const AreaSums::Axis x = patch_axis(map_, map_.width), y = patch_axis(map_, map_.height);
        const std::uint16_t* patches = &patch_of_[static_cast<std::size_t>(y.stored(j) * x.count)];
        for (std::uint16_t& patch : row.top) patch = patches[x.stored(first++)];
    }
    void read_states(std::int64_t first, std::int64_t j, std::vector<std::uint16_t>& states) const noexcept {
        if (map_.edge == StoredMap::Edge::wrap) {
            const std::int64_t row = (j % map_.height + map_.height) % map_.height * std::int64_t{map_.width};
            std::int64_t i = (first % map_.width + map_.width) % map_.width;
            for (std::uint16_t& state : states) {
                state = states_.number(map_.values[static_cast<std::size_t>(row + i)]);
                if (++i == map_.width) i = 0;
            }
        } else {
            for (std::uint16_t& state : states) state = state_at(first++, j);
        }
    }

    /// Texels no larger than a patch.
    Result<Evaluation> inside_patches(const TexelRegion& region, int up, const Budget& budget,
                                      LinearImage& out) const {
        const std::int64_t n = std::int64_t{1} << up, cells = std::int64_t{1} << map_.cells_log2;
        const int texels_log2 = map_.cells_log2 - up;  // of a patch's side
        const std::int64_t left = region.x - (map_.x >> up), top = region.y - (map_.y >> up);
        const std::int64_t mask = (std::int64_t{1} << texels_log2) - 1;
        std::vector<std::array<double, most_functions>> across(static_cast<std::size_t>(region.width));
        for (std::int32_t x = 0; x < region.width; ++x)
            across[static_cast<std::size_t>(x)] = means_over(columns_, ((left + x) & mask) * n, n, cells);
        const std::int64_t first = left >> texels_log2;
        PatchRow patches;
        patches.top.resize(static_cast<std::size_t>(((left + region.width - 1) >> texels_log2) - first + 2));
        patches.bottom.resize(patches.top.size());

        MapSpread spread;
        for (std::int32_t y = 0; y < region.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const bool new_row = y == 0 || ((top + y) & mask) == 0;
            if (new_row) {
                read_row(first, (top + y) >> texels_log2, patches);
                measure(patches, spread);
            }
            const auto down = means_over(rows_, ((top + y) & mask) * n, n, cells);
            float* texel = out.row(y);
            for (std::int32_t x = 0; x < region.width;) {
                const std::int64_t i = (left + x) >> texels_log2;
                const auto at = static_cast<std::size_t>(i - first);
                if (corners_ && texels_log2 == 0) {
                    write(texel, (*corner_patches_)[patches.top[at]].mean);
                    texel += 4;
                    ++x;
                    continue;
                }
                const auto until = static_cast<std::int32_t>(
                    std::min<std::int64_t>(region.width, ((i + 1) << texels_log2) - left));
                std::array<Colour, most_functions> column;
                collapse(patches, at, down, column);
                for (; x < until; ++x, texel += 4)
                    write(texel, combined(across[static_cast<std::size_t>(x)], column));
            }
        }
        const ChanceBound bound = bounds_.of(up, spread);
        return Evaluation{.method = "expectation",
                          .bound_codes = bound.codes + rounding_codes,
                          .confidence = bound.confidence,
                          .work = std::uint64_t(region.width) * std::uint64_t(region.height)};
    }

    void write(float* texel, const Colour& told_from_base) const noexcept {
        for (std::size_t c = 0; c < 4; ++c) texel[c] = static_cast<float>(base_[c] + told_from_base[c]);
    }
    Colour combined(const std::array<double, most_functions>& weights,
                    const std::array<Colour, most_functions>& column) const noexcept {
        Colour sum{};
        for (std::size_t k = 0; k < functions_of(columns_); ++k)
            for (std::size_t c = 0; c < 4; ++c) sum[c] += weights[k] * column[k][c];
        return sum;
    }
    /// A patch along x, at the rows that `down` means.
    void collapse(const PatchRow& patches, std::size_t at, const std::array<double, most_functions>& down,
                  std::array<Colour, most_functions>& column) const noexcept {
        const std::size_t functions = functions_of(columns_);
        std::fill_n(column.begin(), functions, Colour{});
        for (std::size_t row = 0; row < functions_of(rows_); ++row)
            for (std::size_t k = 0; k < functions; ++k) {
                const Colour& colour =
                    corners_ ? (*corner_patches_)[patches.top[at]].coefficients[row * functions + k]
                             : looks_[(row == 0 ? patches.top : patches.bottom)[at + k]].mean;
                for (std::size_t c = 0; c < 4; ++c) column[k][c] += down[row] * colour[c];
            }
    }
    void measure(const PatchRow& patches, MapSpread& spread) const noexcept {
        for (std::size_t at = 0; at + 1 < patches.top.size(); ++at) measure(patches, at, spread);
    }
    void measure(const PatchRow& patches, std::size_t at, MapSpread& spread) const noexcept {
        if (corners_) return spread.add((*corner_patches_)[patches.top[at]]);
        std::array<const LookMixture*, 4> entries;
        std::size_t count = 0;
        for (std::size_t row = 0; row < functions_of(rows_); ++row)
            for (std::size_t k = 0; k < functions_of(columns_); ++k)
                entries[count++] = &looks_[(row == 0 ? patches.top : patches.bottom)[at + k]];
        spread.add_entries(std::span{entries}.first(count));
    }

    /// Texels of 2^log2 × 2^log2 patches, more than one.
    /// `scrolled`: in entries.
    Result<Evaluation> over_patches(const TexelRegion& region, int log2, int up, const Budget& budget,
                                    std::int64_t scrolled, LinearImage& out) const {
        const std::int64_t left = scrolled - (map_.x >> map_.cells_log2), top = -(map_.y >> map_.cells_log2);
        const double share =
            1 / (static_cast<double>(std::int64_t{1} << log2) * static_cast<double>(std::int64_t{1} << log2));
        std::vector<AreaSums::Stretch> columns;
        const bool whole_blocks = sums_->holds(log2);
        if (whole_blocks)
            for (std::int32_t x = 0; x < region.width; ++x)
                columns.push_back(sums_->columns(((region.x + x) << log2) + left, log2));
        for (std::int32_t y = 0; y < region.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            float* texel = out.row(y);
            AreaSums::Stretch rows;
            if (whole_blocks) rows = sums_->rows(((region.y + y) << log2) + top, log2);
            for (std::int32_t x = 0; x < region.width; ++x, texel += 4) {
                Colour sum{};
                if (whole_blocks) {
                    sum = sums_->sum(columns[static_cast<std::size_t>(x)], rows);
                } else {
                    const std::int64_t i = ((region.x + x) << log2) + left,
                                       j = ((region.y + y) << log2) + top;
                    for (std::int64_t row = j; row < j + (std::int64_t{1} << log2); ++row)
                        for (std::int64_t column = i; column < i + (std::int64_t{1} << log2); ++column) {
                            const Colour mean = patch_mean(column, row);
                            for (std::size_t c = 0; c < 4; ++c) sum[c] += mean[c];
                        }
                }
                for (std::size_t c = 0; c < 4; ++c) texel[c] = static_cast<float>(base_[c] + sum[c] * share);
            }
        }
        const ChanceBound of_level = bound(up);
        return Evaluation{.method = "expectation",
                          .bound_codes = of_level.codes + rounding_codes,
                          .confidence = of_level.confidence,
                          .work = std::uint64_t(region.width) * std::uint64_t(region.height)};
    }

    const StoredMap& map_;
    MapBounds bounds_;
    MapStates states_;
    PatchBasis columns_, rows_;
    bool corners_;
    bool drawn_;  ///< States are drawn: the map is dithered.
    Colour base_{};
    std::vector<LookMixture> looks_;                       ///< By state, without corners.
    mutable std::optional<CornerPatches> corner_patches_;  ///< Numbers patches; changes none.
    std::size_t all_patches_ = 0;  ///< Patches are numbered by their states, of so many; 0: as they come.
    mutable std::once_flag tabled_;
    mutable std::vector<std::uint16_t> patch_of_;  ///< With corners: of each stored patch.
    MapSpread spread_;                             ///< Of all patches.
    mutable MapBounds::CellDraws whole_;           ///< A cell's on the average of all patches: of texels of
    int whole_up_ = max_level + 1;                 ///< this many levels above the cell, or more.
    mutable std::optional<PatchSums> sums_;
};

}  // namespace

std::unique_ptr<const AreaExpectation> make_map_expectation(const CellProgram& program,
                                                            const LookMeans& means, std::int32_t slice,
                                                            double uneven) {
    const auto varying = program.varying();
    if (!varying || PatchSums::count(*varying->map) > PatchSums::most) return nullptr;
    auto states = MapStates::of(*varying->map);
    if (!states) return nullptr;
    auto made =
        std::make_unique<const MapExpectation>(program, *varying, std::move(*states), means, slice, uneven);
    if (!made->is_listed()) return nullptr;
    return made;
}

std::uint64_t map_expectation_bytes(const StoredMap& map) noexcept {
    if (PatchSums::count(map) > PatchSums::most) return sundry_bytes;
    const auto patches = static_cast<std::uint64_t>(patch_axis(map, map.width).count) *
                         static_cast<std::uint64_t>(patch_axis(map, map.height).count);
    // Numbers of patches, sums, kinds of patches and states
    return patches * 2 + static_cast<std::uint64_t>(PatchSums::count(map)) * 40 + sundry_bytes;
}

}  // namespace tessera
