#include "server/pattern/sparse_map.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

constexpr int block_log2 = 4;
constexpr std::int32_t block_side = 1 << block_log2;
constexpr std::size_t block_entries = std::size_t{1} << 2 * block_log2;
constexpr std::uint32_t is_mixed = 256;
/// Squares up to this size are counted entry by entry.
constexpr int direct_log2 = 2;

}  // namespace

SparseMap::SparseMap(const StoredMap& map, std::size_t families)
    : width_{map.width},
      height_{map.height},
      wrap_{map.edge == StoredMap::Edge::wrap},
      block_columns_{(static_cast<std::size_t>(map.width) + block_side - 1) >> block_log2},
      block_rows_{(static_cast<std::size_t>(map.height) + block_side - 1) >> block_log2},
      table_log2_{families <= 8 ? 4 : 6},
      table_columns_{(static_cast<std::size_t>(map.width) >> table_log2_) + 1},
      table_rows_{(static_cast<std::size_t>(map.height) >> table_log2_) + 1} {
    // Blocks at the right and lower border are filled up with what is there
    const auto value = [&](std::size_t x, std::size_t y) {
        x = std::min(x, static_cast<std::size_t>(width_) - 1);
        y = std::min(y, static_cast<std::size_t>(height_) - 1);
        return static_cast<std::uint8_t>(map.values[y * static_cast<std::size_t>(width_) + x]);
    };
    blocks_.reserve(block_columns_ * block_rows_);
    for (std::size_t by = 0; by < block_rows_; ++by)
        for (std::size_t bx = 0; bx < block_columns_; ++bx) {
            std::array<std::uint8_t, block_entries> entries;
            for (std::size_t i = 0; i < block_entries; ++i)
                entries[i] = value(bx * block_side + i % block_side, by * block_side + i / block_side);
            if (std::all_of(entries.begin(), entries.end(), [&](auto e) { return e == entries[0]; })) {
                blocks_.push_back(entries[0]);
            } else {
                blocks_.push_back(is_mixed + static_cast<std::uint32_t>(mixed_.size() / block_entries));
                mixed_.insert(mixed_.end(), entries.begin(), entries.end());
            }
        }
    mixed_.shrink_to_fit();

    tables_.assign(families * table_columns_ * table_rows_, 0);
    const std::int32_t side = 1 << table_log2_;
    for (std::size_t family = 0; family < families; ++family)
        for (std::size_t ty = 1; ty < table_rows_; ++ty)
            for (std::size_t tx = 1; tx < table_columns_; ++tx) {
                const auto x = static_cast<std::int32_t>(tx), y = static_cast<std::int32_t>(ty);
                const auto f = static_cast<std::uint8_t>(family);
                tables_[(family * table_rows_ + ty) * table_columns_ + tx] =
                    table(f, x - 1, y) + table(f, x, y - 1) - table(f, x - 1, y - 1) +
                    count(f, (x - 1) * side, (y - 1) * side, x * side, y * side);
            }
}

std::int32_t SparseMap::inside(std::int64_t at, std::int32_t size) const noexcept {
    if (!wrap_) return static_cast<std::int32_t>(std::clamp<std::int64_t>(at, 0, size - 1));
    return static_cast<std::int32_t>((at % size + size) % size);
}

std::uint8_t SparseMap::at(std::int64_t x, std::int64_t y) const noexcept {
    const std::int32_t i = inside(x, width_), j = inside(y, height_);
    const std::uint32_t of = block(i >> block_log2, j >> block_log2);
    if (of < is_mixed) return static_cast<std::uint8_t>(of);
    return mixed_[(of - is_mixed) * block_entries +
                  static_cast<std::size_t>((j % block_side) * block_side + i % block_side)];
}

Families SparseMap::families_in(const EntryRectangle& r) const {
    // At most the whole map; a rectangle over its edge in two parts
    struct Span {
        std::int32_t from, to;
    };
    const auto spans = [&](std::int64_t start, std::int64_t length, std::int32_t size) {
        std::array<Span, 2> parts{};
        if (!wrap_) {
            parts[0] = {inside(start, size), inside(start + length - 1, size) + 1};
        } else if (length >= size) {
            parts[0] = {0, size};
        } else {
            const std::int32_t from = inside(start, size);
            const auto length_32 = static_cast<std::int32_t>(length);
            parts[0] = {from, std::min(from + length_32, size)};
            parts[1] = {0, std::max(from + length_32 - size, 0)};
        }
        return parts;
    };
    Families found;
    for (const Span& rows : spans(r.y, r.height, height_))
        for (const Span& columns : spans(r.x, r.width, width_)) {
            if (rows.from >= rows.to || columns.from >= columns.to) continue;
            for (std::int32_t by = rows.from >> block_log2; by <= (rows.to - 1) >> block_log2; ++by)
                for (std::int32_t bx = columns.from >> block_log2; bx <= (columns.to - 1) >> block_log2;
                     ++bx) {
                    const std::uint32_t of = block(bx, by);
                    if (of < is_mixed) {
                        found.set(of);
                        continue;
                    }
                    for (std::int32_t y = std::max(rows.from, by * block_side);
                         y < std::min(rows.to, (by + 1) * block_side); ++y)
                        for (std::int32_t x = std::max(columns.from, bx * block_side);
                             x < std::min(columns.to, (bx + 1) * block_side); ++x)
                            found.set(at(x, y));
                }
        }
    return found;
}

/// Entries of the map [x0, x1) × [y0, y1), inside it.
std::uint32_t SparseMap::count(std::uint8_t family, std::int32_t x0, std::int32_t y0, std::int32_t x1,
                               std::int32_t y1) const noexcept {
    std::uint32_t total = 0;
    for (std::int32_t y = y0; y < y1;) {
        const std::int32_t below = std::min((y | (block_side - 1)) + 1, y1);
        for (std::int32_t x = x0; x < x1;) {
            const std::int32_t right = std::min((x | (block_side - 1)) + 1, x1);
            const std::uint32_t of = block(x >> block_log2, y >> block_log2);
            if (of == family) {
                total += static_cast<std::uint32_t>((below - y) * (right - x));
            } else if (of >= is_mixed) {
                const std::uint8_t* entries = mixed_.data() + (of - is_mixed) * block_entries;
                for (std::int32_t j = y; j < below; ++j)
                    for (std::int32_t i = x; i < right; ++i)
                        total += entries[(j % block_side) * block_side + i % block_side] == family ? 1u : 0u;
            }
            x = right;
        }
        y = below;
    }
    return total;
}

/// Where the lines between squares fall on the map. The count G up to a line t of the plane (negative before
/// the first entry) is a combination of counts P up to lines of the map: wrapped, t = q·size + r gives
/// q·P(size) + P(r); clamped, what is beyond repeats the last entry: P(size) + (t − size)·(P(size) − P(size −
/// 1)), and before the first t·P(1). Modulo 2^64, where differences are exact.
struct SparseMap::Cuts {
    struct Term {
        std::uint64_t factor = 0;
        std::size_t line = 0;
    };
    std::vector<std::int32_t> lines;      ///< 0 to size.
    std::vector<std::array<Term, 2>> of;  ///< Of each line between squares.
};

SparseMap::Cuts SparseMap::cuts(std::int64_t start, std::int64_t side, std::int32_t count,
                                std::int32_t size) const {
    Cuts cuts{{size, size - 1, 1}, {}};
    for (std::int64_t i = 0; i <= count; ++i) {
        const std::int64_t t = (start + i) * side;
        const auto line = [&](std::int64_t at) {
            cuts.lines.push_back(static_cast<std::int32_t>(at));
            return cuts.lines.size() - 1;
        };
        std::array<Cuts::Term, 2> terms{};
        if (wrap_) {
            const std::int32_t rest = inside(t, size);
            terms[0] = {static_cast<std::uint64_t>((t - rest) / size), 0};
            terms[1] = {1, line(rest)};
        } else if (t < 0) {
            terms[0] = {static_cast<std::uint64_t>(t), 2};
        } else if (t <= size) {
            terms[0] = {1, line(t)};
        } else {
            terms[0] = {static_cast<std::uint64_t>(t - size + 1), 0};
            terms[1] = {static_cast<std::uint64_t>(size - t), 1};
        }
        cuts.of.push_back(terms);
    }
    return cuts;
}

std::vector<float> SparseMap::shares(std::uint8_t family, int k, std::int64_t x, std::int64_t y,
                                     std::int32_t columns, std::int32_t rows) const {
    std::vector<float> shares(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const std::int64_t side = std::int64_t{1} << k;
    const double share = 1.0 / static_cast<double>(side) / static_cast<double>(side);
    if (k <= direct_log2) {
        for (std::int64_t row = 0; row < rows; ++row)
            for (std::int64_t column = 0; column < columns; ++column) {
                const std::int64_t x0 = (x + column) * side, y0 = (y + row) * side;
                std::uint32_t total = 0;
                if (x0 >= 0 && y0 >= 0 && x0 + side <= width_ && y0 + side <= height_) {
                    total = count(family, static_cast<std::int32_t>(x0), static_cast<std::int32_t>(y0),
                                  static_cast<std::int32_t>(x0 + side), static_cast<std::int32_t>(y0 + side));
                } else {
                    for (std::int64_t j = y0; j < y0 + side; ++j)
                        for (std::int64_t i = x0; i < x0 + side; ++i) total += at(i, j) == family ? 1u : 0u;
                }
                shares[static_cast<std::size_t>(row * columns + column)] = static_cast<float>(total * share);
            }
        return shares;
    }

    // Counts up to all lines of the map: tables, and strips from their lines on
    const Cuts across = cuts(x, side, columns, width_), down = cuts(y, side, rows, height_);
    const std::size_t wide = across.lines.size(), high = down.lines.size();
    std::vector<std::uint32_t> counts(wide * high);
    const std::int32_t table_side = 1 << table_log2_;
    std::vector<std::uint32_t> beside(wide * table_rows_, 0), under(table_columns_, 0);
    for (std::size_t i = 0; i < wide; ++i) {
        const std::int32_t to = across.lines[i], from = to & ~(table_side - 1);
        for (std::size_t ty = 1; ty < table_rows_ && from < to; ++ty)
            beside[i * table_rows_ + ty] = beside[i * table_rows_ + ty - 1] +
                                           count(family, from, static_cast<std::int32_t>(ty - 1) * table_side,
                                                 to, static_cast<std::int32_t>(ty) * table_side);
    }
    for (std::size_t j = 0; j < high; ++j) {
        const std::int32_t to_y = down.lines[j], from_y = to_y & ~(table_side - 1);
        for (std::size_t tx = 1; tx < table_columns_; ++tx)
            under[tx] = from_y == to_y
                            ? 0
                            : under[tx - 1] + count(family, static_cast<std::int32_t>(tx - 1) * table_side,
                                                    from_y, static_cast<std::int32_t>(tx) * table_side, to_y);
        for (std::size_t i = 0; i < wide; ++i) {
            const std::int32_t to_x = across.lines[i], from_x = to_x & ~(table_side - 1);
            const std::int32_t tx = from_x >> table_log2_, ty = from_y >> table_log2_;
            counts[j * wide + i] =
                table(family, tx, ty) + beside[i * table_rows_ + static_cast<std::size_t>(ty)] +
                under[static_cast<std::size_t>(tx)] + count(family, from_x, from_y, to_x, to_y);
        }
    }

    // Lines of the plane, then squares between four of them
    const auto pitch = static_cast<std::size_t>(columns) + 1;
    std::vector<std::uint64_t> up_to(pitch * (static_cast<std::size_t>(rows) + 1), 0);
    for (std::size_t j = 0; j < down.of.size(); ++j)
        for (std::size_t i = 0; i < across.of.size(); ++i)
            for (const Cuts::Term& v : down.of[j])
                for (const Cuts::Term& h : across.of[i])
                    up_to[j * pitch + i] += v.factor * h.factor * counts[v.line * wide + h.line];
    for (std::size_t j = 0; j < static_cast<std::size_t>(rows); ++j)
        for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
            const std::uint64_t* upper = &up_to[j * pitch + i];
            const std::uint64_t total = (upper[pitch + 1] - upper[pitch]) - (upper[1] - upper[0]);
            shares[j * static_cast<std::size_t>(columns) + i] =
                static_cast<float>(static_cast<double>(total) * share);
        }
    return shares;
}

std::size_t SparseMap::memory_bytes() const noexcept {
    return sizeof *this + blocks_.size() * sizeof blocks_[0] + mixed_.size() +
           tables_.size() * sizeof tables_[0];
}

}  // namespace tessera
