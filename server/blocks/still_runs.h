#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/blocks/stored_map.h"

namespace tessera {

/// Of an explicit map, how far along a row cells stay in entries of one kind. A part of a row is looked
/// through when it is first asked for: two bits an entry. Any thread may ask.
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
    struct Part;
    /// Along a row of cells, from one to the next that is not of a kind.
    class Walk {
      public:
        Walk() = default;
        /// From cell x on, to the right or to the left; `kind` is not `other`. `runs` lives longer; |x| below
        /// 2^62.
        Walk(const StillRuns& runs, const Row& row, Kind kind, std::int64_t x, bool right) noexcept
            : runs_{&runs}, row_{row}, kind_{kind}, right_{right}, x_{x} {}

        /// The next cell less than `most` cells on that is not of the kind, and which it is of: the next call
        /// goes on behind it. The end of those `most` cells, and the kind, if there is none.
        Found next(std::int64_t most);
        /// As many of the next `most` cells as are found at once and are `other`: their x, and how many there
        /// are. The next call goes on behind what was looked at, x(); next() does where that is nothing.
        std::size_t next_others(std::int64_t most, std::span<std::int64_t> xs);
        std::int64_t x() const noexcept { return x_; }
        /// Goes on behind `cells` that nobody asks for.
        void skip(std::int64_t cells) noexcept {
            x_ += right_ ? cells : -cells;
            known_ = false;
        }

      private:
        std::size_t others_to_right(const Part& part, std::int64_t i, std::int64_t most,
                                    std::span<std::int64_t> xs);
        std::size_t others_to_left(const Part& part, std::int64_t i, std::int64_t most,
                                   std::span<std::int64_t> xs);
        Found to_right(std::int64_t end);
        Found to_left(std::int64_t end);

        const StillRuns* runs_ = nullptr;
        Row row_{};
        Kind kind_ = other;
        bool right_ = true;
        /// That whatever is met next is of the kind, but for `other` ones and those behind a mark.
        bool known_ = false;
        std::int64_t x_ = 0;
    };
    Kind kind_at(std::int64_t x, std::int64_t y) const;
    /// Whether every cell of the row is of `kind`.
    bool all_along(std::int64_t y, Kind kind) const;

  private:
    struct Parts;
    /// Sets a part's bits of the entries [from, end), at most 64. `last`: the kind of the last before them
    /// that is not `other`, and then of theirs.
    void mark(const Row& row, std::int64_t from, std::int64_t end, Kind& last, std::uint64_t& others,
              std::uint64_t& begins) const;
    const Part& part_of(const Row& row, std::int64_t part) const;
    /// The first entry from i on and before `end` that is marked, and whether as `other`; `end` if there is
    /// none.
    std::int64_t next_mark(const Row& row, std::int64_t i, std::int64_t end, bool& is_other) const;
    /// The last from `least` up to and including i; least − 1 if there is none.
    std::int64_t last_mark(const Row& row, std::int64_t i, std::int64_t least, bool& is_other) const;
    Kind kind_of(std::int32_t value) const noexcept;
    std::int32_t value_of(const Row& row, std::int64_t entry) const noexcept;
    /// Outside of the row on one of its sides.
    Kind kind_beside(const Row& row, bool right) const noexcept;
    std::int64_t entry_of(std::int64_t x) const noexcept;

    std::shared_ptr<const StoredMap> map_;
    std::vector<std::int32_t> values_;
    std::vector<Kind> kinds_;
    std::vector<Kind> by_value_;  ///< From the least value on, where they lie close together.
    bool only_one_;               ///< Kind, and no other.
    std::int64_t parts_in_row_;
    std::shared_ptr<Parts> parts_;
};

}  // namespace tessera
