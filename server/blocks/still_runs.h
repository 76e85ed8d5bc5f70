#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/blocks/stored_map.h"

namespace tessera {

/// Of an explicit map, how far along a row cells stay in entries of one kind. A part of a row is looked
/// through when it is first asked for: a bit an entry. Any thread may ask.
class StillRuns {
  public:
    /// Of an entry; kinds from 0 on are told apart, and those of `other` kind are like no one, not even each
    /// other.
    using Kind = std::int32_t;
    static constexpr Kind other = -1;

    /// `kinds`: of the map's possible_values(), in their order.
    StillRuns(std::shared_ptr<const StoredMap> map, std::vector<Kind> kinds);

    /// A row of cells, to be looked along.
    struct Row {
        std::size_t first;  ///< Its first entry, counted in the map.
        std::size_t first_part;
        bool blank;  ///< It shows nothing of the map.
    };
    Row row_of(std::int64_t y) const noexcept;
    struct Found {
        std::int64_t x;
        Kind kind;
    };
    /// The first cell from x on to the right, less than `most` away, that is not of `kind`; x + most, of that
    /// kind, if there is none. |x| and x + most below 2^62.
    Found right(const Row& row, std::int64_t x, Kind kind, std::int64_t most) const;
    /// The same to the left; x − most if there is none.
    Found left(const Row& row, std::int64_t x, Kind kind, std::int64_t most) const;
    Kind kind_at(std::int64_t x, std::int64_t y) const;
    /// Whether every cell of the row is of `kind`.
    bool all_along(std::int64_t y, Kind kind) const;

  private:
    struct Part;
    struct Parts;
    /// A bit for each of the entries [from, end), at most 64.
    std::uint64_t begins_of(const Row& row, std::int64_t from, std::int64_t end) const;
    const Part& part_of(const Row& row, std::int64_t part) const;
    /// The first begin of a run between entries i and `end`, both excluded; `end` if there is none.
    std::int64_t next_begin(const Row& row, std::int64_t i, std::int64_t end) const;
    /// The last begin from entry `least` up to and including i; `least` if there is none.
    std::int64_t last_begin(const Row& row, std::int64_t i, std::int64_t least) const;
    Kind kind_of(std::int32_t value) const noexcept;
    std::int32_t value_of(const Row& row, std::int64_t entry) const noexcept;
    /// Outside of the row on one of its sides.
    Kind kind_beside(const Row& row, bool right) const noexcept;
    std::int64_t entry_of(std::int64_t x) const noexcept;

    std::shared_ptr<const StoredMap> map_;
    std::vector<std::int32_t> values_;
    std::vector<Kind> kinds_;
    std::vector<Kind> by_value_;  ///< From the least value on, where they lie close together.
    std::int64_t parts_in_row_;
    std::shared_ptr<Parts> parts_;
};

}  // namespace tessera
