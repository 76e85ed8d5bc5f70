// Probability Map (3.2): "a probability map simply contains the indices of the patterns to be used".
#include "server/blocks/material_lists.h"

namespace tessera {

Result<void> compile_probability_map(Compilation& c, std::size_t block) {
    const proto::ProbabilityMap& message = c.graph.blocks[block].message->probability_map();
    const auto index = c.integer(block, ".index", message.index(), 0);
    if (!index) return index.error();
    auto list = read_material(c, block, ".material", message.material());
    if (!list) return list.error();
    return add_single_list(c, block, std::move(*list), *index);
}

}  // namespace tessera
