#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/blocks/stored_map.h"

namespace tessera {

/// The distinct integers of a map (and −1 where it may be blank outside), numbered from 0 on in rising order.
class MapStates {
  public:
    /// Nothing where there are more than 2^16 of them, or they are too far apart to be listed.
    static std::optional<MapStates> of(const StoredMap& map);

    const std::vector<std::int32_t>& values() const noexcept { return values_; }
    std::uint16_t number(std::int32_t value) const noexcept {
        return numbers_[static_cast<std::size_t>(std::int64_t{value} - values_.front())];
    }
    std::size_t memory_bytes() const noexcept {
        return numbers_.size() * sizeof numbers_[0] + values_.size() * sizeof values_[0];
    }

  private:
    std::vector<std::int32_t> values_;
    std::vector<std::uint16_t> numbers_;  ///< [value − least]
};

}  // namespace tessera
