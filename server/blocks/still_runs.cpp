#include "server/blocks/still_runs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <utility>

namespace tessera {

namespace {

constexpr std::int64_t word_bits = 64, part_words = 16, part_bits = word_bits * part_words;
/// A table of the values' kinds may have so many entries; else they are searched for.
constexpr std::int64_t most_listed = std::int64_t{1} << 16;

}  // namespace

/// Of some entries of a row a bit for each at which a run begins: that is of `other` kind, or of another than
/// the one left of it. The first entry of a row is one.
struct StillRuns::Part {
    std::array<std::uint64_t, part_words> begins{};
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

std::uint64_t StillRuns::begins_of(const Row& row, std::int64_t from, std::int64_t end) const {
    const auto count = static_cast<std::size_t>(end - from);
    std::array<std::int32_t, word_bits> values;
    map_->values.copy(row.first + static_cast<std::size_t>(from), count, values.data());
    // Kinds change where values do, and nearly always few do: compared a group at a time
    constexpr std::size_t group = 16;
    std::uint64_t changes = 1;
    for (std::size_t i = 1; i < count; i += group) {
        const std::size_t more = std::min(group, count - i);
        if (std::memcmp(&values[i], &values[i - 1], more * sizeof values[0]) == 0) continue;
        for (std::size_t j = i; j < i + more; ++j) changes |= std::uint64_t{values[j] != values[j - 1]} << j;
    }
    const std::uint64_t all = ~std::uint64_t{0} >> (word_bits - count);
    Kind last = from > 0 ? kind_of(value_of(row, from - 1)) : other;
    std::uint64_t begins = from == 0 ? 1 : 0;
    // From change to change all are of one kind
    for (std::uint64_t left = changes; left != 0;) {
        const int i = std::countr_zero(left);
        left &= left - 1;
        const Kind kind = kind_of(values[static_cast<std::size_t>(i)]);
        if (kind != last) begins |= std::uint64_t{1} << i;
        if (kind == other)
            begins |= all & ~std::uint64_t{0} << i &
                      (left == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << std::countr_zero(left)) - 1);
        last = kind;
    }
    return begins;
}

const StillRuns::Part& StillRuns::part_of(const Row& row, std::int64_t number) const {
    std::atomic<const Part*>& place = parts_->all[row.first_part + static_cast<std::size_t>(number)];
    if (const Part* known = place.load(std::memory_order_acquire)) return *known;
    auto part = std::make_unique<Part>();
    const std::int64_t first = number * part_bits,
                       end = std::min<std::int64_t>(first + part_bits, map_->width);
    for (std::size_t word = 0; word < part_words; ++word) {
        const std::int64_t from = first + static_cast<std::int64_t>(word) * word_bits;
        if (from < end) part->begins[word] = begins_of(row, from, std::min(from + word_bits, end));
    }
    // Others may have been as fast
    const Part* nobody = nullptr;
    if (place.compare_exchange_strong(nobody, part.get(), std::memory_order_acq_rel)) return *part.release();
    return *nobody;
}

std::int64_t StillRuns::next_begin(const Row& row, std::int64_t i, std::int64_t end) const {
    for (++i; i < end; i = (i / part_bits + 1) * part_bits) {
        const Part& part = part_of(row, i / part_bits);
        auto word = static_cast<std::size_t>(i % part_bits / word_bits);
        std::uint64_t bits = part.begins[word] & (~std::uint64_t{0} << (i % word_bits));
        while (bits == 0 && ++word < part_words) bits = part.begins[word];
        if (bits != 0)
            return std::min(end, i / part_bits * part_bits + static_cast<std::int64_t>(word) * word_bits +
                                     std::countr_zero(bits));
    }
    return end;
}

std::int64_t StillRuns::last_begin(const Row& row, std::int64_t i, std::int64_t least) const {
    for (; i >= least; i = i / part_bits * part_bits - 1) {
        const Part& part = part_of(row, i / part_bits);
        auto word = static_cast<std::size_t>(i % part_bits / word_bits);
        std::uint64_t bits = part.begins[word] & (~std::uint64_t{0} >> (word_bits - 1 - i % word_bits));
        while (bits == 0 && word > 0) bits = part.begins[--word];
        if (bits != 0)
            return std::max(least, i / part_bits * part_bits + static_cast<std::int64_t>(word) * word_bits +
                                       (word_bits - 1 - std::countl_zero(bits)));
    }
    return least;
}

bool StillRuns::all_along(std::int64_t y, Kind kind) const {
    const Row row = row_of(y);
    if (row.blank) return kind_of(-1) == kind;
    if (map_->edge == StoredMap::Edge::blank && kind_of(-1) != kind) return false;
    // Of one that lies in the map at last in part
    return kind_of(value_of(row, 0)) == kind && next_begin(row, 0, map_->width) == map_->width;
}

StillRuns::Found StillRuns::right(const Row& row, std::int64_t x, Kind kind, std::int64_t most) const {
    const Found none{x + most, kind};
    if (most <= 0) return none;
    if (row.blank) return kind_of(-1) == kind ? none : Found{x, kind_of(-1)};
    const std::int64_t width = map_->width, last = entry_of(x + most - 1);
    const auto found = [&](std::int64_t entry, Kind is) {
        return Found{std::max(x, (entry << map_->cells_log2) + map_->x), is};
    };
    std::int64_t entry = entry_of(x);
    if (map_->edge != StoredMap::Edge::wrap) {
        if (entry < 0) {
            if (const Kind is = kind_beside(row, false); is != kind) return {x, is};
            entry = 0;
        }
        for (; entry < width && entry <= last; entry = next_begin(row, entry, std::min(width, last + 1)))
            if (const Kind is = kind_of(value_of(row, entry)); is != kind) return found(entry, is);
        const Kind beside = kind_beside(row, true);
        return entry > last || beside == kind ? none : found(entry, beside);
    }
    // Once round is enough
    const std::int64_t round_last = std::min(last, entry + width - 1);
    for (std::int64_t i = StoredMap::wrapped(entry, map_->width); entry <= round_last;) {
        if (const Kind is = kind_of(value_of(row, i)); is != kind) return found(entry, is);
        const std::int64_t next = next_begin(row, i, std::min(width, i + (round_last - entry) + 1));
        entry += next - i;
        i = next == width ? 0 : next;
    }
    return none;
}

StillRuns::Found StillRuns::left(const Row& row, std::int64_t x, Kind kind, std::int64_t most) const {
    const Found none{x - most, kind};
    if (most <= 0) return none;
    if (row.blank) return kind_of(-1) == kind ? none : Found{x, kind_of(-1)};
    const std::int64_t width = map_->width, last = entry_of(x - most + 1);
    const auto found = [&](std::int64_t entry, Kind is) {
        return Found{std::min(x, ((entry + 1) << map_->cells_log2) - 1 + map_->x), is};
    };
    std::int64_t entry = entry_of(x);
    if (map_->edge != StoredMap::Edge::wrap) {
        if (entry >= width) {
            if (const Kind is = kind_beside(row, true); is != kind) return {x, is};
            entry = width - 1;
        }
        const std::int64_t least = std::max<std::int64_t>(last, 0);
        for (; entry >= 0 && entry >= last; entry = last_begin(row, entry, least) - 1)
            if (const Kind is = kind_of(value_of(row, entry)); is != kind) return found(entry, is);
        const Kind beside = kind_beside(row, false);
        return entry < last || beside == kind ? none : found(entry, beside);
    }
    const std::int64_t round_last = std::max(last, entry - width + 1);
    for (std::int64_t i = StoredMap::wrapped(entry, map_->width); entry >= round_last;) {
        if (const Kind is = kind_of(value_of(row, i)); is != kind) return found(entry, is);
        const std::int64_t begin = last_begin(row, i, std::max<std::int64_t>(0, i - (entry - round_last)));
        entry -= i - begin + 1;
        i = begin == 0 ? width - 1 : begin - 1;
    }
    return none;
}

}  // namespace tessera
