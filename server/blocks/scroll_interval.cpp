#include "server/blocks/scroll_interval.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "server/blocks/scroll_way.h"

namespace tessera {

namespace {

/// Of the shifts that are looked at, at most: see scroll_interval().
std::int64_t most_shifts(const CellBlock& block) noexcept {
    const auto height_log2 = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(block.height - 1)));
    return std::int64_t{1} << std::clamp(20 - height_log2, 8, 16);
}
/// Where nothing is known of runs.
std::int64_t fewer_shifts(const CellBlock& block) noexcept {
    return std::max<std::int64_t>(most_shifts(block) / 16, 64);
}
/// Where places show this and that.
constexpr std::int64_t few_shifts = 16;

/// Places that all show one look: what comes in is looked at, and how long it stays that look.
class AlikeSearch {
  public:
    AlikeSearch(const CellBlock& block, const Look& look, const StandingCells& cells, ScrollWay& way)
        : block_{block},
          look_{look},
          cells_{cells},
          way_{way},
          by_{std::abs(way.cells())},
          width_shifts_{block.width / by_},
          width_left_{block.width % by_},
          fewer_{fewer_shifts(block)},
          some_shifts_{way.is_later() ? 8 : 1} {}

    void run() {
        // Where cells come round to the first ones again, others stand beside each other: as far as that at a
        // time
        for (std::int64_t from = 0; from <= way_.last() && !way_.ended_before(way_.enter(from));) {
            const std::int64_t shifted = way_.shifted(from);
            const auto room =
                way_.cells() > 0 ? static_cast<std::int64_t>(Scroll::again) - 1 - shifted : shifted;
            base_ = from;
            left_ = block_.x + shifted;
            last_ = last_counted_ = std::min(way_.last(), from + room / by_);
            if (from > 0 && way_.is_cut(from, fewer_) &&
                cells_.still_at(way_.between(from), look_).kind == StillRuns::other)
                return way_.change_into(way_.enter(from));
            stand_still_from(from);
            search_from(std::max<std::int64_t>(from, 1));
            from = last_ + 1;
        }
    }

  private:
    /// Which cells are known to stand still in shift `from`, and up to which one after it.
    void stand_still_from(std::int64_t from) {
        still_ = cells_.still_at(way_.enter(from), look_);
        if (still_.kind == StillRuns::other)
            for (std::int64_t k = from + 1; k <= last_; ++k)
                if (way_.is_cut(k, fewer_)) last_ = k - 1;
        const Step end = way_.after(still_.holds);
        if (way_.is_beyond(end, last_)) return;
        const std::int64_t last = way_.shift_of(end) - 1;
        // In a shift in which that changes, all are asked
        if (last < from) still_ = {};
        last_ = std::max(from, last);
    }

    /// Whether the same cells are known to stand still from shift last_ + 1 on, and not only up to that one:
    /// then they are looked at together.
    bool goes_on_alike() {
        if (still_.kind == StillRuns::other || last_ >= last_counted_) return false;
        const StandingCells::Still next = cells_.still_at(way_.enter(last_ + 1), look_);
        if (next.runs != still_.runs || next.kind != still_.kind) return false;
        const Step end = way_.after(next.holds);
        const std::int64_t last = way_.is_beyond(end, last_counted_) ? last_counted_ : way_.shift_of(end) - 1;
        if (last <= last_) return false;
        last_ = last;
        return true;
    }

    /// Cells are counted from the one that leaves first, at shift base_: cell number n is there at shift k if
    /// 0 ≤ n − (k − base_)·by_ < width.
    std::int64_t x_of(std::int64_t number) const noexcept {
        return way_.cells() > 0 ? left_ + number : left_ + block_.width - 1 - number;
    }

    /// The shifts in which a cell is there, of those that are looked at.
    struct Stay {
        std::int64_t comes, goes;
    };
    Stay stay_of(std::int64_t number) const noexcept {
        const std::int64_t shift = number / by_;
        const std::int64_t comes = shift - width_shifts_ + (number - shift * by_ >= width_left_ ? 1 : 0);
        return {std::max(first_, base_ + comes), std::min(last_, base_ + shift)};
    }

    void search_from(std::int64_t first) {
        first_ = first;
        const std::int64_t begin = (first - base_) * by_;
        rows_.assign(static_cast<std::size_t>(block_.height), {.next = begin});
        if (still_.kind != StillRuns::other)
            for (std::size_t row = 0; row < rows_.size(); ++row)
                rows_[row].entries = {*still_.runs,
                                      still_.runs->row_of(block_.y + static_cast<std::int64_t>(row)),
                                      still_.kind, x_of(begin), way_.cells() > 0};
        for (std::int64_t k = first; k <= last_;) {
            while (k + some_shifts_ + width_shifts_ >= last_ && goes_on_alike()) continue;
            const std::int64_t to = std::min(last_, k + some_shifts_ - 1);
            found_ = 0;
            find((to - base_) * by_ + block_.width);
            ask();
            if (way_.ended_before(way_.leave(to))) return;
            k = to + 1;
            // Who asks at the first step of an interval finds its end at once, on the way back
            if (found_ < enough_found) some_shifts_ *= 2;
        }
    }

    /// How far a row was looked through: up to its cell number `next`.
    struct RowPlace {
        std::int64_t next = 0;
        StillRuns::Walk entries{};
    };
    std::int64_t number_of(std::int64_t x) const noexcept {
        return way_.cells() > 0 ? x - left_ : left_ + block_.width - 1 - x;
    }
    /// Of cells before number `end` the next that may show something else, and whether they do: their
    /// numbers, in the order of these.
    struct Next {
        std::size_t count = 0;
        bool certain = false;
    };
    Next look_on(RowPlace& place, std::int64_t end, std::span<std::int64_t> numbers) const {
        if (still_.kind == StillRuns::other) {
            const std::int64_t count = std::min(std::ssize(numbers), end - place.next);
            std::iota(numbers.begin(), numbers.begin() + count, place.next);
            place.next += count;
            return {static_cast<std::size_t>(count)};
        }
        StillRuns::Walk& entries = place.entries;
        const std::size_t count = entries.next_others(end - place.next, numbers);
        place.next = number_of(entries.x());
        for (std::int64_t& number : numbers.first(count)) number = number_of(number);
        if (count > 0 || place.next >= end) return {count};
        const StillRuns::Found found = entries.next(end - place.next);
        place.next = number_of(entries.x());
        numbers.front() = number_of(found.x);
        return {found.kind == still_.kind ? 0u : 1u, found.kind != StillRuns::other};
    }

    /// Asks for cells before number `end` that may show something else.
    void find(std::int64_t end) {
        for (std::size_t row = 0; row < rows_.size(); ++row)
            while (rows_[row].next < end)
                find_some(rows_[row], block_.y + static_cast<std::int64_t>(row), end);
    }
    void find_some(RowPlace& place, std::int64_t y, std::int64_t end) {
        std::array<std::int64_t, some_cells> numbers;
        const Next next = look_on(place, end, numbers);
        std::size_t count = 0;
        for (const std::int64_t number : std::span{numbers}.first(next.count)) {
            const auto [comes, goes] = stay_of(number);
            if (comes > goes) {
                // Between where two shifts put the block
                const std::int64_t there = number - number % by_ + by_;
                if (place.next >= there) continue;
                place.entries.skip(there - place.next);
                place.next = there;
                continue;
            }
            const Step step = way_.enter(comes);
            const bool ended = way_.ended_before(step);
            if (next.certain && !ended) way_.change_into(step);
            if (next.certain || ended) {
                place.next = end;  // So do those after it
                break;
            }
            some_[count++] = {x_of(number), y, step, way_.within(step, goes)};
        }
        count = cells_.sift(std::span{some_}.first(count), look_);
        asked_.insert(asked_.end(), some_.begin(), some_.begin() + static_cast<std::ptrdiff_t>(count));
        found_ += static_cast<int>(count);
        // What may not rest nearly always changes: that spares looking further
        if (asked_.size() >= (cells_.sifts() ? 1 : most_asked)) ask();
    }

    void ask() {
        while (!asked_.empty()) {
            looks_.resize(asked_.size());
            frames_.resize(asked_.size());
            cells_.ask(asked_, looks_, frames_);
            std::size_t again = 0;
            for (std::size_t i = 0; i < asked_.size(); ++i) {
                if (!cells_.same(looks_[i], look_)) {
                    way_.change_into(asked_[i].step);
                    continue;
                }
                const Step next = way_.after(frames_[i]);
                const std::int64_t goes = stay_of(number_of(asked_[i].x)).goes;
                if (way_.is_beyond(next, goes) || way_.ended_before(next)) continue;
                if (!way_.is_shift(next)) {
                    way_.change_into(next);
                    continue;
                }
                // Another frame, but where cells are compared by what they show
                asked_[again++] = {asked_[i].x, asked_[i].y, next, asked_[i].within};
            }
            asked_.resize(again);
        }
    }

    static constexpr std::size_t some_cells = 32;  ///< Of a row, that are looked for at once.
    static constexpr std::size_t most_asked = 32;  ///< At once: what is found spares asking others.
    static constexpr int enough_found = 12;        ///< Among some shifts, that more of them are too many.

    const CellBlock& block_;
    const Look& look_;
    const StandingCells& cells_;
    ScrollWay& way_;
    StandingCells::Still still_;
    std::int64_t by_, width_shifts_, width_left_, fewer_;
    std::int64_t base_ = 0, left_ = 0, first_ = 1, last_ = 0,
                 last_counted_ = 0;  ///< As far as cells are counted from the same one.
    std::vector<RowPlace> rows_;
    std::int64_t some_shifts_;  ///< That are looked at next.
    int found_ = 0;
    std::vector<CellAt> asked_;
    std::array<CellAt, some_cells> some_;
    std::vector<Look> looks_;
    std::vector<Validity> frames_;
};

/// Places that show this and that: nearly always a shift changes some of them, and one is enough to see it.
class MixedSearch {
  public:
    MixedSearch(const CellBlock& block, const SeenCells& seen, const Validity& frames,
                const StandingCells& cells, ScrollWay& way)
        : block_{block}, seen_{seen}, frames_{frames}, cells_{cells}, way_{way} {}

    void run() {
        if (told_by_seen()) return way_.change_into(way_.enter(1));
        for (std::int64_t k = 1; k <= way_.last(); ++k) {
            if (differs(k)) way_.change_into(way_.enter(k));
            if (way_.ended_before(way_.leave(k))) return;
        }
    }

  private:
    /// The row that was kept shows something else a shift further, where its cells keep their frames until
    /// then.
    bool told_by_seen() const {
        if (!seen_.differs_shifted()) return false;
        if (way_.after(frames_) != way_.enter(1)) return true;
        const SeenCells::Odd& odd = way_.cells() > 0 ? seen_.first() : seen_.second();
        return changes(odd.x, odd.y, odd.look, 1);
    }
    bool changes(std::int64_t x, std::int64_t y, const Look& look, std::int64_t k) const {
        const Step step = way_.enter(k);
        const CellAt cell{x + way_.shifted(k), y, step, {step, add_steps(step, 1)}};
        Look other;
        Validity frames;
        cells_.ask({&cell, 1}, {&other, 1}, {&frames, 1});
        return !cells_.same(look, other);
    }

    /// Whether shift k shows something else than shift 0; if not, what changes in it is told to the way.
    bool differs(std::int64_t k) {
        // The row that was told apart first, and in each the part that was: nearly always that is enough
        const std::int64_t odd_x = seen_.first().x - block_.x, odd_y = seen_.first().y - block_.y;
        const std::int64_t first = std::clamp<std::int64_t>(odd_x, 0, block_.width - 1) / some * some;
        for (std::int64_t row = 0; row < block_.height; ++row) {
            const std::int64_t y = block_.y + (odd_y + row) % block_.height;
            for (std::int64_t x = first; x < block_.width; x += some)
                if (differ(x, y, k)) return true;
            for (std::int64_t x = 0; x < first; x += some)
                if (differ(x, y, k)) return true;
        }
        return false;
    }
    /// The same of some cells of a row, from cell x of the block on.
    bool differ(std::int64_t x, std::int64_t y, std::int64_t k) {
        const auto count = static_cast<std::size_t>(std::min(some, block_.width - x));
        std::array<CellAt, 2 * some> cells;
        std::array<Look, 2 * some> looks;
        std::array<Validity, 2 * some> frames;
        const Step step = way_.enter(k);
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t at = block_.x + x + static_cast<std::int64_t>(i);
            cells[i] = {at + way_.shifted(0), y, block_.step, {block_.step, add_steps(block_.step, 1)}};
            cells[count + i] = {at + way_.shifted(k), y, step, way_.within(step, k)};
        }
        cells_.ask(std::span{cells}.first(2 * count), std::span{looks}.first(2 * count),
                   std::span{frames}.first(2 * count));
        for (std::size_t i = 0; i < count; ++i) {
            if (!cells_.same(looks[i], looks[count + i])) return true;
            const Step next = way_.after(frames[count + i]);
            if (!way_.is_beyond(next, k)) way_.change_into(next);
        }
        return false;
    }

    static constexpr std::int64_t some = 4;  ///< Cells of a row that are compared at once.

    const CellBlock& block_;
    const SeenCells& seen_;
    const Validity& frames_;
    const StandingCells& cells_;
    ScrollWay& way_;
};

/// Whether nothing else ever comes into the block's rows.
bool is_for_ever(const CellBlock& block, const Look& look, const StandingCells& cells) {
    const StandingCells::Still still = cells.still_ever(look);
    if (still.kind == StillRuns::other) return false;
    for (std::int64_t y = block.y; y < block.y + block.height; ++y)
        if (!still.runs->all_along(y, still.kind)) return false;
    return true;
}

/// After how many shifts cells come again; 0 if nobody knows, or where they come round to the first ones at
/// another.
std::int64_t shifts_again(const Scroll& scroll, const StandingCells& cells) noexcept {
    const std::int64_t again = cells.comes_again();
    constexpr std::int64_t most = 4096;
    if (again == 0 || Scroll::again % static_cast<std::uint64_t>(again) != 0) return 0;
    const std::int64_t shifts = again / std::gcd(again, std::int64_t{scroll.cells});
    return shifts <= most ? shifts : 0;
}

/// Whether the row that was kept shows something else a shift later, and a shift sooner: asked together,
/// since nearly every page of this and that needs both, and no more.
bool differs_on_both_sides(const Scroll& scroll, std::int64_t shift, const Validity& in_shift,
                           const SeenCells& seen, const StandingCells& cells) {
    if (!seen.differs_shifted()) return false;
    const bool left = scroll.cells > 0;
    const std::array odds{left ? seen.first() : seen.second(), left ? seen.second() : seen.first()};
    const std::array<Step, 2> steps{in_shift.until, in_shift.from - 1};
    const std::array<CellAt, 2> places{
        {{odds[0].x + scroll.shifted(shift + 1), odds[0].y, steps[0], {steps[0], steps[0] + 1}},
         {odds[1].x + scroll.shifted(shift - 1), odds[1].y, steps[1], {steps[1], steps[1] + 1}}}};
    std::array<Look, 2> looks;
    std::array<Validity, 2> frames;
    cells.ask(places, looks, frames);
    return !cells.same(looks[0], odds[0].look) && !cells.same(looks[1], odds[1].look);
}

}  // namespace

Validity scroll_interval(const Scroll& scroll, const CellBlock& block, const SeenCells& seen,
                         const Validity& frames, const StandingCells& cells) {
    const Validity in_shift = scroll.at(block.step).validity;
    Validity validity = frames;
    validity.meet(in_shift);
    if (seen.empty()) return validity;
    if (seen.alike() && is_for_ever(block, seen.look(), cells)) return {};
    const std::int64_t shift = scroll.shift_at(block.step);
    const std::int64_t round = seen.alike() ? 0 : shifts_again(scroll, cells);
    const auto reach = [&](bool later) {
        const std::int64_t most = seen.alike() ? most_shifts(block) : few_shifts;
        ScrollWay way = round > 0 ? ScrollWay::around(scroll, shift, later, round)
                                  : ScrollWay{scroll, shift, later, most};
        if (seen.alike())
            AlikeSearch{block, seen.look(), cells, way}.run();
        else
            MixedSearch{block, seen, frames, cells, way}.run();
        return way.end();
    };
    const bool goes_on = validity.until == in_shift.until && validity.until != never,
               goes_back = validity.from == in_shift.from && validity.from != always;
    if (goes_on && goes_back && !seen.alike() && differs_on_both_sides(scroll, shift, in_shift, seen, cells))
        return validity;
    if (goes_on) validity.until = reach(true);
    if (goes_back) validity.from = reach(false);
    return validity;
}

}  // namespace tessera
