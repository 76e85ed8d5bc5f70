#include "server/blocks/still_runs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <utility>

namespace tessera {

namespace {

constexpr int word_bits = 64;
constexpr std::int64_t part_words = 16, part_bits = word_bits * part_words;
/// A table of the values' kinds may have so many entries; else they are searched for.
constexpr std::int64_t most_listed = std::int64_t{1} << 16;

constexpr std::size_t group = 16;
constexpr std::array<std::uint32_t, group> bit_of = [] {
    std::array<std::uint32_t, group> bits{};
    for (std::size_t i = 0; i < group; ++i) bits[i] = std::uint32_t{1} << i;
    return bits;
}();

/// A bit for each of 64 values that differs from the one in front of it: a sum, which takes few instructions.
std::uint64_t changes_of(const std::array<std::int32_t, word_bits + 1>& values) noexcept {
    std::uint64_t changes = 0;
    for (std::size_t i = 0; i < word_bits; i += group) {
        std::uint32_t bits = 0;
        for (std::size_t j = 0; j < group; ++j)
            bits += values[i + j + 1] != values[i + j] ? bit_of[j] : std::uint32_t{0};
        changes |= std::uint64_t{bits} << i;
    }
    return changes;
}

}  // namespace

/// Of some entries of a row two bits for each: whether it is of `other` kind; and if not, whether it is of
/// another kind than the last before it that is not, or the first in the part.
struct StillRuns::Part {
    std::array<std::uint64_t, part_words> others{}, begins{};
};

/// Of each row those that were asked for.
struct StillRuns::Parts {
    explicit Parts(std::size_t count) : all(count) {}
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() {
        for (const auto& part : all) delete part.load();
    }
    std::vector<std::atomic<const Part*>> all;
};

StillRuns::StillRuns(std::shared_ptr<const StoredMap> map, std::vector<Kind> kinds)
    : map_{std::move(map)},
      values_{possible_values(*map_)},
      kinds_{std::move(kinds)},
      only_one_{kinds_.front() != other &&
                std::all_of(kinds_.begin(), kinds_.end(), [&](Kind kind) { return kind == kinds_.front(); })},
      parts_in_row_{(map_->width + part_bits - 1) / part_bits},
      parts_{std::make_shared<Parts>(static_cast<std::size_t>(parts_in_row_ * map_->height))} {
    const std::int64_t span = std::int64_t{values_.back()} - values_.front() + 1;
    if (span > most_listed) return;
    by_value_.assign(static_cast<std::size_t>(span), other);
    for (std::size_t i = 0; i < values_.size(); ++i)
        by_value_[static_cast<std::size_t>(std::int64_t{values_[i]} - values_.front())] = kinds_[i];
}

StillRuns::Kind StillRuns::kind_of(std::int32_t value) const noexcept {
    if (!by_value_.empty()) return by_value_[static_cast<std::size_t>(std::int64_t{value} - values_.front())];
    const auto found = std::lower_bound(values_.begin(), values_.end(), value);
    return kinds_[static_cast<std::size_t>(found - values_.begin())];
}

std::int32_t StillRuns::value_of(const Row& row, std::int64_t entry) const noexcept {
    return map_->values[row.first + static_cast<std::size_t>(entry)];
}

StillRuns::Kind StillRuns::kind_beside(const Row& row, bool right) const noexcept {
    if (map_->edge == StoredMap::Edge::blank) return kind_of(-1);
    return kind_of(value_of(row, right ? map_->width - 1 : 0));
}

std::int64_t StillRuns::entry_of(std::int64_t x) const noexcept { return (x - map_->x) >> map_->cells_log2; }

StillRuns::Kind StillRuns::kind_at(std::int64_t x, std::int64_t y) const {
    return kind_of(map_->entry(entry_of(x), (y - map_->y) >> map_->cells_log2));
}

StillRuns::Row StillRuns::row_of(std::int64_t y) const noexcept {
    std::int64_t j = (y - map_->y) >> map_->cells_log2;
    const bool blank = map_->edge == StoredMap::Edge::blank && (j < 0 || j >= map_->height);
    j = map_->edge == StoredMap::Edge::wrap ? StoredMap::wrapped(j, map_->height)
                                            : std::clamp<std::int64_t>(j, 0, map_->height - 1);
    return {static_cast<std::size_t>(j * map_->width), static_cast<std::size_t>(j * parts_in_row_), blank};
}

void StillRuns::mark(const Row& row, std::int64_t from, std::int64_t end, Kind& last, std::uint64_t& others,
                     std::uint64_t& begins) const {
    const auto count = static_cast<std::size_t>(end - from);
    // One more in front, which the first is compared with
    std::array<std::int32_t, word_bits + 1> values;
    map_->values.copy(row.first + static_cast<std::size_t>(from), count, values.data() + 1);
    std::fill(values.begin() + 1 + static_cast<std::ptrdiff_t>(count), values.end(), values[count]);
    values[0] = values[1];
    std::uint64_t left = changes_of(values) | 1;
    // From change to change all are of one kind, and nearly always there are few
    while (left != 0) {
        const int i = std::countr_zero(left);
        left &= left - 1;
        const Kind kind = kind_of(values[static_cast<std::size_t>(i) + 1]);
        if (kind == other) {
            const std::uint64_t before = left == 0 ? ~std::uint64_t{0} >> (word_bits - count)
                                                   : (std::uint64_t{1} << std::countr_zero(left)) - 1;
            others |= before & ~std::uint64_t{0} << i;
            continue;
        }
        if (kind != last) begins |= std::uint64_t{1} << i;
        last = kind;
    }
}

const StillRuns::Part& StillRuns::part_of(const Row& row, std::int64_t number) const {
    std::atomic<const Part*>& place = parts_->all[row.first_part + static_cast<std::size_t>(number)];
    if (const Part* known = place.load(std::memory_order_acquire)) return *known;
    auto part = std::make_unique<Part>();
    const std::int64_t first = number * part_bits,
                       end = std::min<std::int64_t>(first + part_bits, map_->width);
    Kind last = other;
    for (std::size_t word = 0; word < part_words; ++word) {
        const std::int64_t from = first + static_cast<std::int64_t>(word) * word_bits;
        if (from >= end) break;
        mark(row, from, std::min(from + word_bits, end), last, part->others[word], part->begins[word]);
    }
    // Others may have been as fast
    const Part* nobody = nullptr;
    if (place.compare_exchange_strong(nobody, part.get(), std::memory_order_acq_rel)) return *part.release();
    return *nobody;
}

std::int64_t StillRuns::next_mark(const Row& row, std::int64_t i, std::int64_t end, bool& is_other) const {
    for (; i < end; i = (i / part_bits + 1) * part_bits) {
        const Part& part = part_of(row, i / part_bits);
        auto word = static_cast<std::size_t>(i % part_bits / word_bits);
        std::uint64_t bits = (part.others[word] | part.begins[word]) & (~std::uint64_t{0} << (i % word_bits));
        while (bits == 0 && ++word < part_words) bits = part.others[word] | part.begins[word];
        if (bits == 0) continue;
        const int bit = std::countr_zero(bits);
        is_other = (part.others[word] >> bit & 1) != 0;
        return std::min(end, i / part_bits * part_bits + static_cast<std::int64_t>(word) * word_bits + bit);
    }
    return end;
}

std::int64_t StillRuns::last_mark(const Row& row, std::int64_t i, std::int64_t least, bool& is_other) const {
    for (; i >= least; i = i / part_bits * part_bits - 1) {
        const Part& part = part_of(row, i / part_bits);
        auto word = static_cast<std::size_t>(i % part_bits / word_bits);
        std::uint64_t bits =
            (part.others[word] | part.begins[word]) & (~std::uint64_t{0} >> (word_bits - 1 - i % word_bits));
        while (bits == 0 && word > 0) {
            --word;
            bits = part.others[word] | part.begins[word];
        }
        if (bits == 0) continue;
        const int bit = word_bits - 1 - std::countl_zero(bits);
        is_other = (part.others[word] >> bit & 1) != 0;
        return std::max(least - 1,
                        i / part_bits * part_bits + static_cast<std::int64_t>(word) * word_bits + bit);
    }
    return least - 1;
}

bool StillRuns::all_along(std::int64_t y, Kind kind) const {
    const Row row = row_of(y);
    if (row.blank) return kind_of(-1) == kind;
    if (map_->edge == StoredMap::Edge::blank && kind_of(-1) != kind) return false;
    // Of one that lies in the map at last in part
    const std::int64_t first = map_->x, cells = std::int64_t{map_->width} << map_->cells_log2;
    return Walk{*this, row, kind, first, true}.next(cells).kind == kind;
}

StillRuns::Found StillRuns::Walk::next(std::int64_t most) {
    const std::int64_t end = right_ ? x_ + most : x_ - most;
    const Found found = most <= 0 || runs_->only_one_ ? Found{end, kind_}
                        : right_                      ? to_right(end)
                                                      : to_left(end);
    x_ = found.kind == kind_ ? end : found.x + (right_ ? 1 : -1);
    return found;
}

std::size_t StillRuns::Walk::next_others(std::int64_t most, std::span<std::int64_t> xs) {
    const StoredMap& map = *runs_->map_;
    if (row_.blank || map.cells_log2 != 0 || runs_->only_one_) return 0;
    std::int64_t i = x_ - map.x;
    if (map.edge == StoredMap::Edge::wrap) i = StoredMap::wrapped(i, map.width);
    if (i < 0 || i >= map.width) return 0;
    if (!known_) {
        if (most <= 0 || runs_->kind_of(runs_->value_of(row_, i)) != kind_) return 0;
        known_ = true;
        if (right_) {  // What begins with this entry is of the kind
            ++x_, --most;
            if (++i == map.width) return 0;
        }
    }
    const std::int64_t number = i / part_bits, first = number * part_bits;
    const Part& part = runs_->part_of(row_, number);
    return right_ ? others_to_right(part, i - first, std::min({most, part_bits - (i - first), map.width - i}),
                                    xs)
                  : others_to_left(part, i - first, std::min(most, i - first + 1), xs);
}

std::size_t StillRuns::Walk::others_to_right(const Part& part, std::int64_t i, std::int64_t most,
                                             std::span<std::int64_t> xs) {
    const std::int64_t base = x_ - i, end = i + most;
    std::size_t count = 0;
    for (; i < end; i = (i / word_bits + 1) * word_bits) {
        const auto word = static_cast<std::size_t>(i / word_bits);
        const std::uint64_t from = ~std::uint64_t{0} << (i % word_bits), begins = part.begins[word] & from;
        // Up to where another run may begin
        const int stop = std::countr_zero(begins);
        std::uint64_t others = part.others[word] & from;
        if (begins != 0) others &= (std::uint64_t{1} << stop) - 1;
        const std::int64_t at = base + static_cast<std::int64_t>(word) * word_bits;
        for (; others != 0; others &= others - 1) {
            if (count == xs.size()) return count;
            const std::int64_t x = at + std::countr_zero(others);
            if (x >= base + end) break;
            xs[count++] = x;
            x_ = x + 1;
        }
        if (begins != 0) {
            x_ = std::min(base + end, at + stop);
            return count;
        }
    }
    x_ = base + end;
    return count;
}

std::size_t StillRuns::Walk::others_to_left(const Part& part, std::int64_t i, std::int64_t most,
                                            std::span<std::int64_t> xs) {
    const std::int64_t base = x_ - i, end = i - most;
    std::size_t count = 0;
    for (; i > end; i = i / word_bits * word_bits - 1) {
        const auto word = static_cast<std::size_t>(i / word_bits);
        const std::uint64_t from = ~std::uint64_t{0} >> (word_bits - 1 - i % word_bits),
                            begins = part.begins[word] & from;
        std::uint64_t others = part.others[word] & from;
        const std::int64_t at = base + static_cast<std::int64_t>(word) * word_bits;
        const int stop = word_bits - 1 - std::countl_zero(begins);
        if (begins != 0) others &= ~std::uint64_t{0} << stop;
        while (others != 0) {
            if (count == xs.size()) return count;
            const int bit = word_bits - 1 - std::countl_zero(others);
            if (at + bit <= base + end) break;
            xs[count++] = at + bit;
            x_ = at + bit - 1;
            others ^= std::uint64_t{1} << bit;
        }
        if (begins != 0) {
            x_ = std::max(base + end, at + stop);
            return count;
        }
    }
    x_ = base + end;
    return count;
}

StillRuns::Found StillRuns::Walk::to_right(std::int64_t end) {
    const StillRuns& runs = *runs_;
    const StoredMap& map = *runs.map_;
    const Found none{end, kind_};
    if (row_.blank) return runs.kind_of(-1) == kind_ ? none : Found{x_, runs.kind_of(-1)};
    const std::int64_t width = map.width, last = runs.entry_of(end - 1);
    std::int64_t entry = runs.entry_of(x_);
    const auto found = [&](std::int64_t at, Kind is) {
        return Found{std::max(x_, (at << map.cells_log2) + map.x), is};
    };
    if (map.edge != StoredMap::Edge::wrap && entry < 0) {
        if (const Kind is = runs.kind_beside(row_, false); is != kind_) return {x_, is};
        entry = 0;
    }
    // Once round is enough
    const std::int64_t stop =
        map.edge == StoredMap::Edge::wrap ? std::min(last + 1, entry + width) : std::min(last + 1, width);
    while (entry < stop) {
        const std::int64_t i = StoredMap::wrapped(entry, map.width),
                           row_end = std::min(width, i + (stop - entry));
        bool is_other = false;
        const std::int64_t mark = known_ ? runs.next_mark(row_, i, row_end, is_other) : i;
        entry += mark - i;
        if (mark == row_end) continue;
        const Kind is = is_other ? other : runs.kind_of(runs.value_of(row_, mark));
        known_ = is == kind_ || is_other;
        if (is != kind_) return found(entry, is);
        ++entry;
    }
    if (entry > last || map.edge == StoredMap::Edge::wrap) return none;
    const Kind beside = runs.kind_beside(row_, true);
    return beside == kind_ ? none : found(entry, beside);
}

StillRuns::Found StillRuns::Walk::to_left(std::int64_t end) {
    const StillRuns& runs = *runs_;
    const StoredMap& map = *runs.map_;
    const Found none{end, kind_};
    if (row_.blank) return runs.kind_of(-1) == kind_ ? none : Found{x_, runs.kind_of(-1)};
    const std::int64_t width = map.width, last = runs.entry_of(end + 1);
    std::int64_t entry = runs.entry_of(x_);
    const auto found = [&](std::int64_t at, Kind is) {
        return Found{std::min(x_, ((at + 1) << map.cells_log2) - 1 + map.x), is};
    };
    if (map.edge != StoredMap::Edge::wrap && entry >= width) {
        if (const Kind is = runs.kind_beside(row_, true); is != kind_) return {x_, is};
        entry = width - 1;
    }
    const std::int64_t least = map.edge == StoredMap::Edge::wrap ? std::max(last, entry - width + 1)
                                                                 : std::max<std::int64_t>(last, 0);
    while (entry >= least) {
        const std::int64_t i = StoredMap::wrapped(entry, map.width),
                           row_least = std::max<std::int64_t>(0, i - (entry - least));
        if (known_) {
            bool is_other = false;
            const std::int64_t mark = runs.last_mark(row_, i, row_least, is_other);
            entry -= i - mark;
            if (mark < row_least) continue;
            if (is_other) return found(entry, other);
            // The run begins there, with an entry of this kind
            known_ = false;
            --entry;
            continue;
        }
        const Kind is = runs.kind_of(runs.value_of(row_, i));
        if (is != kind_) return found(entry, is);
        known_ = true;  // What begins with this entry is looked at again
    }
    if (entry < last || map.edge == StoredMap::Edge::wrap) return none;
    const Kind beside = runs.kind_beside(row_, false);
    return beside == kind_ ? none : found(entry, beside);
}

}  // namespace tessera
