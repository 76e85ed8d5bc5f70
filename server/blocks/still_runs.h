#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/blocks/stored_map.h"

namespace tessera {

/// Of an explicit map, how far along a row cells stay in entries of one kind. A row is looked through when it
/// is first asked for: a bit an entry. Any thread may ask.
class StillRuns {
  public:
    /// Of an entry; kinds from 0 on are told apart, and those of `other` kind are like no one, not even each
    /// other.
    using Kind = std::int32_t;
    static constexpr Kind other = -1;

    /// `kinds`: of the map's possible_values(), in their order.
    StillRuns(std::shared_ptr<const StoredMap> map, std::vector<Kind> kinds);

    /// The first cell from (x, y) on to the right, less than `most` away, that is not of `kind`; x + most if
    /// there is none. |x|, |y| and x + most below 2^62.
    std::int64_t right(std::int64_t x, std::int64_t y, Kind kind, std::int64_t most) const;
    /// The same to the left; x − most if there is none.
    std::int64_t left(std::int64_t x, std::int64_t y, Kind kind, std::int64_t most) const;
    Kind kind_at(std::int64_t x, std::int64_t y) const;
    /// Whether every cell of the row is of `kind`.
    bool all_along(std::int64_t y, Kind kind) const;

  private:
    struct Row;
    bool is_blank(std::int64_t y) const noexcept;
    bool is_all(const Row& row, Kind kind) const noexcept;
    const Row& row_of(std::int64_t y) const;
    Kind kind_of(std::int32_t value) const noexcept;
    /// Of entry i, which may lie outside.
    Kind kind_of_entry(std::int64_t i, std::int64_t y) const noexcept;
    std::int64_t entry_of(std::int64_t x) const noexcept;

    std::shared_ptr<const StoredMap> map_;
    std::vector<std::int32_t> values_;
    std::vector<Kind> kinds_;
    std::vector<Kind> by_value_;  ///< From the least value on, where they lie close together.
    struct Rows;
    std::shared_ptr<Rows> rows_;
};

}  // namespace tessera
