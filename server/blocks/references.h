#pragma once

#include <string_view>
#include <vector>

#include "proto/pattern.pb.h"

#include "server/blocks/graph.h"

namespace tessera {

/// What can be said of a block by its message alone.
struct BlockShape {
    std::string_view kind;  ///< Empty: none is set.
    Output output{};
    std::vector<BlockReference> references;
};

BlockShape shape_of(const proto::Block& block);

}  // namespace tessera
