#include "server/blocks/look_program.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <functional>
#include <numeric>

#include "server/blocks/kernels.h"
#include "server/blocks/look_shares.h"
#include "server/blocks/running_cells.h"
#include "server/blocks/seen_cells.h"

namespace tessera {

namespace {

/// Rows of integers, kept by each thread from one stretch to the next; and what they were for, so that a row
/// of cells that follows on the last need not decide again what both read.
class ThreadRows {
  public:
    static ThreadRows& of_this_thread() {
        thread_local ThreadRows rows;
        return rows;
    }
    /// Runs `schedule`, which is number `id` of all that ever were.
    const std::int32_t* run(const CellSchedule& schedule, std::uint64_t id, const Stretch& stretch) {
        if (space_.size() < schedule.space()) space_.resize(schedule.space());
        const bool follows = id_ == id && last_.x == stretch.x && last_.y == stretch.y - 1 &&
                             last_.z == stretch.z && last_.step == stretch.step &&
                             last_.count == stretch.count;
        schedule.run(stretch, space_.data(), follows);
        id_ = id;
        last_ = stretch;
        return space_.data();
    }

  private:
    std::vector<std::int32_t> space_;
    std::uint64_t id_ = 0;
    Stretch last_;
};

/// A number that no other schedule of this process has.
std::uint64_t next_id() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

class LookProgram final : public CellProgram {
  public:
    LookProgram(const std::shared_ptr<const std::vector<CellNode>>& nodes,
                const std::array<std::size_t, 5>& roots, const LookSteps& steps, std::uint32_t types,
                int cell_log2, const Scroll& scroll)
        : cell_log2_{cell_log2},
          shares_{nodes, roots[0], roots[3], roots[4], steps},
          steps_{steps},
          patterns_{*nodes, std::span{roots}.first(1), CellSchedule::Rows::stretches},
          looks_{*nodes, roots, CellSchedule::Rows::stretches},
          kernels_{block_kernels()} {
        const Classified found = classify(*nodes, roots);
        // Cells that are all alike show nothing of it
        if (found.other || found.drawn || found.typed || found.targets) scroll_ = scroll;
        needs_types_ = found.typed;
        period_ = found.period;
        moves_ = found.steps || scroll_.cells != 0;
        clocked_ = found.clocked || scroll_.cells != 0;
        looks_at_targets_ = found.targets;
        basis_ = shares_.basis();
        if (basis_ == Basis::constant || basis_ == Basis::typed) {
            // Places count too where the type is to say all
            if (found.other || found.drawn)
                basis_ = Basis::stationary;
            else
                basis_ = found.typed ? Basis::typed : Basis::constant;
            if (moves_) basis_ = Basis::stationary;
        }
        if (basis_ == Basis::constant || basis_ == Basis::typed) tabulate(basis_ == Basis::typed ? types : 1);
        if (scroll_.cells != 0) {
            // Places in a cell are no part of what is listed
            const CellNode &x = (*nodes)[roots[1]], &y = (*nodes)[roots[2]];
            const bool placed = x.constant() && y.constant();
            const Look place{.x = place_of(x.least), .y = place_of(y.least)};
            running_.emplace(
                scroll_, placed && !found.driven ? shares_.varying() : std::nullopt, found.animation,
                [this, place](std::int32_t value, std::size_t setting) {
                    return looks_in(value, setting, place);
                },
                !found.steps && !found.drawn, framed_cells(*nodes, roots));
        }
    }

    void patterns(const CellRow& row, std::int32_t* out) const override {
        if (tabulated()) {
            if (basis_ == Basis::typed)
                kernels_.look_up_types(pattern_of_type_.data(), row.types, row.count, out);
            else
                std::fill_n(out, row.count, pattern_of_type_.front());
            return;
        }
        ThreadRows& rows = ThreadRows::of_this_thread();
        for (std::int32_t done = 0; done < row.count; done += stretch_cells) {
            const Stretch stretch = stretch_of(row, done);
            const std::int32_t* space = rows.run(patterns_, patterns_id_, stretch);
            std::copy_n(patterns_.root(0, space), stretch.count, out + done);
        }
    }

    void looks(const CellRow& row, Look* out) const override {
        if (tabulated()) {
            for (std::int32_t i = 0; i < row.count; ++i)
                out[i] = look_of_type_[basis_ == Basis::typed ? row.types[i] : 0];
            return;
        }
        ThreadRows& rows = ThreadRows::of_this_thread();
        for (std::int32_t done = 0; done < row.count; done += stretch_cells) {
            const Stretch stretch = stretch_of(row, done);
            const std::int32_t* space = rows.run(looks_, looks_id_, stretch);
            pack(space, stretch.count, out + done);
        }
    }

    Basis basis() const noexcept override { return basis_; }
    bool moves() const noexcept override { return moves_; }
    bool clocked() const noexcept override { return clocked_; }
    bool looks_at_targets() const noexcept override { return looks_at_targets_; }
    Scroll scroll() const noexcept override { return scroll_; }
    Validity through_shifts(const CellBlock& block, const SeenCells& seen,
                            const Validity& frames) const override {
        if (!running_) return frames;
        const bool only_patterns = seen.only_patterns();
        const auto ask = [&](std::span<const CellAt> cells, std::span<Look> looks,
                             std::span<Validity> validities) {
            if ((only_patterns ? patterns_ : looks_).scatters())
                ask_scattered(block, cells, only_patterns, looks, validities);
            else
                ask_each(block, cells, only_patterns, looks, validities);
        };
        return running_->through_shifts(block, seen, frames, std::cref(ask));  // By itself it were copied
    }
    Validity through_map(const CellBlock& block) const override {
        return running_ ? running_->through_map(block) : Validity{};
    }
    Epoch epoch(Step step, std::int32_t parameter, double most_uneven) const override {
        return shares_.epoch(step, parameter, most_uneven);
    }
    std::vector<LookShare> shares_in(const Epoch& epoch,
                                     std::span<const std::int32_t> states) const override {
        return shares_.shares(states, epoch);
    }
    bool needs_types() const noexcept override { return needs_types_; }
    std::int64_t period() const noexcept override { return period_; }
    bool independent_cells() const noexcept override { return shares_.independent_cells(); }
    Look look_of_type(std::uint16_t type) const override {
        if (look_of_type_.empty()) return {};
        return look_of_type_[basis_ == Basis::typed ? type : 0];
    }
    std::optional<VaryingMap> varying() const override { return shares_.varying(); }
    std::vector<LookShare> shares(std::span<const std::int32_t> states) const override {
        return shares_.shares(states);
    }
    std::vector<std::int32_t> nested_patterns() const override { return shares_.nested_patterns(); }
    std::size_t memory_bytes() const noexcept override {
        return looks_.memory_bytes() + (running_ ? running_->memory_bytes() : 0) +
               pattern_of_type_.size() * sizeof(std::int32_t) + look_of_type_.size() * sizeof(Look);
    }

  private:
    struct Classified {
        bool typed = false, drawn = false, other = false, steps = false, clocked = false, targets = false;
        std::int64_t period = 1;  ///< 0: none that is known.
        bool driven = false;
        const AnimationOp* animation = nullptr;

        void add_period(std::int64_t cells) noexcept {
            period = period == 0 || cells == 0 ? 0 : std::max(period, cells);
        }
    };
    /// After how many cells a draw comes again, along x and y; 0: never, or by no power of two.
    static std::int64_t period_of(const CellDraw& draw) noexcept {
        if (draw.generator != proto::Draw::sigma || !std::has_single_bit(draw.count)) return 0;
        return std::int64_t{draw.count} * draw.count * draw.count;
    }
    static std::int64_t period_of(const CellMap& map) noexcept {
        const StoredMap& stored = *map.map;
        const auto width = static_cast<std::uint32_t>(stored.width),
                   height = static_cast<std::uint32_t>(stored.height);
        if (map.sampling != VaryingMap::Sampling::nearest || stored.edge != StoredMap::Edge::wrap ||
            !std::has_single_bit(width) || !std::has_single_bit(height))
            return 0;
        return std::int64_t{std::max(width, height)} << stored.cells_log2;
    }
    static Classified classify(const std::vector<CellNode>& nodes, const std::array<std::size_t, 5>& roots) {
        std::vector<bool> needed(nodes.size(), false);
        for (const std::size_t root : roots) needed[root] = true;
        Classified found;
        for (std::size_t node = nodes.size(); node-- > 0;) {
            if (!needed[node]) continue;
            for (const std::size_t input : nodes[node].inputs) needed[input] = true;
            found.steps |= nodes[node].steps;
            found.clocked |= nodes[node].animation != nullptr;
            found.driven |= nodes[node].driven != nullptr;
            if (nodes[node].animation) found.animation = nodes[node].animation.get();
            found.targets |= nodes[node].driven && nodes[node].driven->looks_at_targets();
            found.other |= nodes[node].map.has_value();
            if (nodes[node].steps) found.period = 0;
            if (nodes[node].map) found.add_period(period_of(*nodes[node].map));
            if (!nodes[node].draw) continue;
            found.add_period(period_of(*nodes[node].draw));
            const bool is_typed = nodes[node].draw->generator == proto::Draw::typed;
            found.typed |= is_typed;
            found.drawn |= !is_typed;
        }
        return found;
    }

    /// Where a look is what an animation shows, and nothing else about it changes from cell to cell.
    std::optional<RunningCells::Framed> framed_cells(const std::vector<CellNode>& nodes,
                                                     const std::array<std::size_t, 5>& roots) const {
        for (std::size_t root = 1; root < roots.size(); ++root)
            if (!nodes[roots[root]].constant()) return std::nullopt;
        auto cycles = MappedCycles::of(nodes, roots[0]);
        if (!cycles) return std::nullopt;
        const auto constant = [&](std::size_t root) { return nodes[roots[root]].least; };
        return RunningCells::Framed{std::move(*cycles),
                                    {.x = place_of(constant(1)),
                                     .y = place_of(constant(2)),
                                     .turn = steps_.turn(constant(3)),
                                     .scale = steps_.scale(constant(4))}};
    }

    Stretch stretch_of(const CellRow& row, std::int32_t done) const noexcept {
        return {.x = row.x + scroll_.at(row.step).shift + done,
                .y = row.y,
                .z = row.z,
                .step = row.step,
                .count = std::min(row.count - done, stretch_cells),
                .types = row.types == nullptr ? nullptr : row.types + done,
                .validity = row.validity,
                .parameter = row.parameter,
                .targets = row.targets,
                .cell_log2 = cell_log2_};
    }

    /// All that cells in entries of a value may show under a setting.
    std::vector<Look> looks_in(std::int32_t value, std::size_t setting, const Look& place) const {
        std::vector<Look> looks;
        for (const LookShare& share : shares_.shares(std::span{&value, 1}, {.setting = setting}))
            if (share.share > 0) looks.push_back({share.pattern, place.x, place.y, share.turn, share.scale});
        return looks;
    }
    void ask_scattered(const CellBlock& block, std::span<const CellAt> cells, bool only_patterns,
                       std::span<Look> looks, std::span<Validity> frames) const {
        ThreadRows& rows = ThreadRows::of_this_thread();
        const CellSchedule& schedule = only_patterns ? patterns_ : looks_;
        std::fill(frames.begin(), frames.end(), Validity{});
        for (std::size_t done = 0; done < cells.size(); done += stretch_cells) {
            const Stretch stretch{
                .z = block.z,
                .count = static_cast<std::int32_t>(std::min<std::size_t>(cells.size() - done, stretch_cells)),
                .parameter = block.parameter,
                .targets = block.targets,
                .cell_log2 = cell_log2_,
                .scattered = cells.data() + done,
                .frames = frames.data() + done};
            const std::int32_t* space = rows.run(schedule, 0, stretch);
            if (!only_patterns) {
                pack(space, stretch.count, looks.data() + done);
                continue;
            }
            const std::int32_t* pattern = schedule.root(0, space);
            for (std::size_t i = 0; i < static_cast<std::size_t>(stretch.count); ++i)
                looks[done + i] = {.pattern = pattern[i]};
        }
    }
    void ask_each(const CellBlock& block, std::span<const CellAt> cells, bool only_patterns,
                  std::span<Look> looks, std::span<Validity> frames) const {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            frames[i] = {};
            const CellRow row{.x = cells[i].x - scroll_.at(cells[i].step).shift,
                              .y = cells[i].y,
                              .count = 1,
                              .z = block.z,
                              .step = cells[i].step,
                              .validity = &frames[i],
                              .parameter = block.parameter,
                              .targets = block.targets};
            looks[i] = {};
            if (only_patterns)
                patterns(row, &looks[i].pattern);
            else
                this->looks(row, &looks[i]);
        }
    }
    static std::uint16_t place_of(std::int32_t number) noexcept {
        return static_cast<std::uint16_t>(std::min(number, number_one - 1));
    }

    bool tabulated() const noexcept { return !pattern_of_type_.empty(); }

    void pack(const std::int32_t* space, std::int32_t count, Look* out) const noexcept {
        const std::int32_t *pattern = looks_.root(0, space), *x = looks_.root(1, space),
                           *y = looks_.root(2, space), *turn = looks_.root(3, space),
                           *scale = looks_.root(4, space);
        for (std::int32_t i = 0; i < count; ++i)
            out[i] = {pattern[i], place_of(x[i]), place_of(y[i]), steps_.turn(turn[i]),
                      steps_.scale(scale[i])};
    }

    void tabulate(std::uint32_t types) {
        std::vector<std::uint16_t> all(types);
        std::iota(all.begin(), all.end(), std::uint16_t{0});
        std::vector<std::int32_t> space(looks_.space());
        look_of_type_.resize(types);
        const CellRow row{.count = static_cast<std::int32_t>(types), .types = all.data()};
        for (std::int32_t done = 0; done < row.count; done += stretch_cells) {
            const Stretch stretch = stretch_of(row, done);
            looks_.run(stretch, space.data());
            pack(space.data(), stretch.count, look_of_type_.data() + done);
        }
        for (const Look& look : look_of_type_) pattern_of_type_.push_back(look.pattern);
    }

    int cell_log2_;
    Scroll scroll_;
    LookShares shares_;
    LookSteps steps_;
    CellSchedule patterns_, looks_;
    std::uint64_t patterns_id_ = next_id(), looks_id_ = next_id();
    const BlockKernels& kernels_;
    Basis basis_ = Basis::other;
    bool needs_types_ = false, moves_ = false, clocked_ = false, looks_at_targets_ = false;
    std::int64_t period_ = 0;
    std::vector<std::int32_t> pattern_of_type_;
    std::vector<Look> look_of_type_;
    std::optional<RunningCells> running_;  ///< Where cells scroll.
};

}  // namespace

std::shared_ptr<const CellProgram> make_look_program(std::shared_ptr<const std::vector<CellNode>> nodes,
                                                     const std::array<std::size_t, 5>& roots,
                                                     const LookSteps& steps, std::uint32_t types,
                                                     int cell_log2, const Scroll& scroll) {
    return std::make_shared<LookProgram>(nodes, roots, steps, types, cell_log2, scroll);
}

}  // namespace tessera
