#pragma once

#include <memory>

#include "server/blocks/compilation.h"

namespace tessera {

/// The entry of `map` that each cell lies in.
std::shared_ptr<const CellOp> make_map_op(std::shared_ptr<const StoredMap> map);

/// A map's node: the same for indirection maps and areas maps.
Result<void> compile_map(Compilation& c, std::size_t block, const proto::ExplicitMap& message);

/// "8 × 8 entries of 16 cells"
std::string map_note(const StoredMap& map);

}  // namespace tessera
