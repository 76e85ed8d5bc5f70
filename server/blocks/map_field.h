#pragma once

#include <memory>
#include <string_view>

#include "server/blocks/compilation.h"

namespace tessera {

inline constexpr std::int64_t max_map_cell = std::int64_t{1}
                                             << 40;  ///< Maps begin nearer than this to the origin.
inline constexpr std::int32_t max_map_side = 32768;
inline constexpr std::int64_t max_map_entries = std::int64_t{1} << 26;

/// Checks an explicit map's fields and reads its entries. `field` is its path behind the block's.
Result<std::shared_ptr<const StoredMap>> read_explicit_map(Compilation& c, std::size_t block,
                                                           std::string_view field,
                                                           const proto::ExplicitMap& message);

/// A map that is written into the scene file: rows of `width`, from the top.
Result<StoredMap> map_of_values(Compilation& c, std::size_t block, std::string_view field,
                                const google::protobuf::RepeatedField<std::int32_t>& values,
                                std::uint32_t width);

/// Checks what read_map() gave: sides, number of entries. `field` is for messages.
Result<void> check_map_size(Compilation& c, std::size_t block, std::string_view field, const StoredMap& map);

/// log2 of `value` where it is a power of two from 1 to 2^most_log2; 0 stands for `unset`. Else −1.
int power_of_two(std::uint32_t value, std::uint32_t unset, int most_log2) noexcept;

/// The least and the most of what the map shows somewhere.
std::pair<std::int32_t, std::int32_t> map_range(const StoredMap& map);

}  // namespace tessera
