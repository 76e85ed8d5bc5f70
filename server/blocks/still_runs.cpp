#include "server/blocks/still_runs.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace tessera {

namespace {

constexpr std::int64_t word_bits = 64;
/// A table of the values' kinds may have so many entries; else they are searched for.
constexpr std::int64_t most_listed = std::int64_t{1} << 16;

/// Into 0 to `side` − 1, with one division.
std::int64_t wrapped(std::int64_t i, std::int32_t side) noexcept {
    i %= side;
    return i < 0 ? i + side : i;
}

}  // namespace

/// A bit for each entry at which a run begins: that is of `other` kind, or of another than the one left of
/// it.
struct StillRuns::Row {
    std::vector<std::uint64_t> begins;
    Kind single = other;  ///< Of all of them, if they are of one.
    const std::int32_t* values = nullptr;

    Kind kind(std::int64_t i, const StillRuns& of) const noexcept { return of.kind_of(values[i]); }

    /// The first begin behind entry i; `width` if there is none.
    std::int64_t behind(std::int64_t i, std::int64_t width) const noexcept {
        ++i;
        auto word = static_cast<std::size_t>(i / word_bits);
        if (word >= begins.size()) return width;
        std::uint64_t bits = begins[word] & (~std::uint64_t{0} << (i % word_bits));
        while (bits == 0) {
            if (++word == begins.size()) return width;
            bits = begins[word];
        }
        return static_cast<std::int64_t>(word) * word_bits + std::countr_zero(bits);
    }
    /// The last begin up to and including entry i: there is one, entry 0.
    std::int64_t before(std::int64_t i) const noexcept {
        auto word = static_cast<std::size_t>(i / word_bits);
        std::uint64_t bits = begins[word] & (~std::uint64_t{0} >> (word_bits - 1 - i % word_bits));
        while (bits == 0) bits = begins[--word];
        return static_cast<std::int64_t>(word) * word_bits + (word_bits - 1 - std::countl_zero(bits));
    }
};

struct StillRuns::Rows {
    explicit Rows(std::int32_t height) : rows(static_cast<std::size_t>(height)) {}
    Rows(const Rows&) = delete;
    Rows& operator=(const Rows&) = delete;
    ~Rows() {
        for (const auto& row : rows) delete row.load();
    }
    std::vector<std::atomic<const Row*>> rows;
};

StillRuns::StillRuns(std::shared_ptr<const StoredMap> map, std::vector<Kind> kinds)
    : map_{std::move(map)},
      values_{possible_values(*map_)},
      kinds_{std::move(kinds)},
      rows_{std::make_shared<Rows>(map_->height)} {
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

StillRuns::Kind StillRuns::kind_of_entry(std::int64_t i, std::int64_t y) const noexcept {
    return kind_of(map_->entry(i, (y - map_->y) >> map_->cells_log2));
}

std::int64_t StillRuns::entry_of(std::int64_t x) const noexcept { return (x - map_->x) >> map_->cells_log2; }

StillRuns::Kind StillRuns::kind_at(std::int64_t x, std::int64_t y) const {
    return kind_of_entry(entry_of(x), y);
}

const StillRuns::Row& StillRuns::row_of(std::int64_t y) const {
    std::int64_t j = (y - map_->y) >> map_->cells_log2;
    j = map_->edge == StoredMap::Edge::wrap ? wrapped(j, map_->height)
                                            : std::clamp<std::int64_t>(j, 0, map_->height - 1);
    std::atomic<const Row*>& place = rows_->rows[static_cast<std::size_t>(j)];
    if (const Row* known = place.load(std::memory_order_acquire)) return *known;
    auto row = std::make_unique<Row>();
    row->begins.assign(static_cast<std::size_t>((map_->width + word_bits - 1) / word_bits), 0);
    const std::int32_t* values = map_->values.data() + j * map_->width;
    row->values = values;
    Kind last = other;
    std::int64_t count = 0;
    for (std::int64_t i = 0; i < map_->width; ++i) {
        const Kind kind = kind_of(values[i]);
        if (i > 0 && kind == last && kind != other) continue;
        row->begins[static_cast<std::size_t>(i / word_bits)] |= std::uint64_t{1} << (i % word_bits);
        last = kind;
        ++count;
    }
    if (count == 1) row->single = last;
    // Others may have been as fast
    const Row* nobody = nullptr;
    if (place.compare_exchange_strong(nobody, row.get(), std::memory_order_acq_rel)) return *row.release();
    return *nobody;
}

/// Whether the row shows nothing of the map.
bool StillRuns::is_blank(std::int64_t y) const noexcept {
    const std::int64_t j = (y - map_->y) >> map_->cells_log2;
    return map_->edge == StoredMap::Edge::blank && (j < 0 || j >= map_->height);
}

bool StillRuns::all_along(std::int64_t y, Kind kind) const {
    return is_blank(y) ? kind_of(-1) == kind : is_all(row_of(y), kind);
}

/// Of a row that lies in the map at last in part, and what is beside it.
bool StillRuns::is_all(const Row& row, Kind kind) const noexcept {
    return row.single == kind && (map_->edge != StoredMap::Edge::blank || kind_of(-1) == kind);
}

std::int64_t StillRuns::right(std::int64_t x, std::int64_t y, Kind kind, std::int64_t most) const {
    const std::int64_t end = x + most;
    if (most <= 0) return end;
    if (is_blank(y)) return kind_of(-1) == kind ? end : x;
    const Row& row = row_of(y);
    if (is_all(row, kind)) return end;
    const std::int64_t width = map_->width, last = entry_of(end - 1);
    std::int64_t entry = entry_of(x);
    if (map_->edge != StoredMap::Edge::wrap) {
        if (entry < 0) {
            if (kind_of_entry(entry, y) != kind) return x;
            entry = 0;
        }
        for (; entry < width && entry <= last; entry = row.behind(entry, width))
            if (row.kind(entry, *this) != kind) return std::max(x, (entry << map_->cells_log2) + map_->x);
        if (entry > last || kind_of_entry(width, y) == kind) return end;
        return std::max(x, (entry << map_->cells_log2) + map_->x);
    }
    for (std::int64_t i = wrapped(entry, map_->width); entry <= last;) {
        if (row.kind(i, *this) != kind) return std::max(x, (entry << map_->cells_log2) + map_->x);
        const std::int64_t next = row.behind(i, width);
        entry += next - i;
        i = next == width ? 0 : next;
    }
    return end;
}

std::int64_t StillRuns::left(std::int64_t x, std::int64_t y, Kind kind, std::int64_t most) const {
    const std::int64_t end = x - most;
    if (most <= 0) return end;
    if (is_blank(y)) return kind_of(-1) == kind ? end : x;
    const Row& row = row_of(y);
    if (is_all(row, kind)) return end;
    const std::int64_t width = map_->width, last = entry_of(end + 1);
    const auto right_of = [&](std::int64_t entry) {
        return std::min(x, ((entry + 1) << map_->cells_log2) - 1 + map_->x);
    };
    std::int64_t entry = entry_of(x);
    if (map_->edge != StoredMap::Edge::wrap) {
        if (entry >= width) {
            if (kind_of_entry(entry, y) != kind) return x;
            entry = width - 1;
        }
        for (; entry >= 0 && entry >= last; entry = row.before(entry) - 1)
            if (row.kind(entry, *this) != kind) return right_of(entry);
        if (entry < last || kind_of_entry(-1, y) == kind) return end;
        return right_of(entry);
    }
    for (std::int64_t i = wrapped(entry, map_->width); entry >= last;) {
        if (row.kind(i, *this) != kind) return right_of(entry);
        const std::int64_t begin = row.before(i);
        entry -= i - begin + 1;
        i = begin == 0 ? width - 1 : begin - 1;
    }
    return end;
}

}  // namespace tessera
