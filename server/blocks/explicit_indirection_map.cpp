// Explicit Indirection Map (3.2): "a value in I encodes the pattern number p to be used in the corresponding
// cell".
#include "server/blocks/areas_map.h"

namespace tessera {

Result<void> compile_explicit_indirection_map(Compilation& c, std::size_t block) {
    return compile_map(c, block, c.graph.blocks[block].message->explicit_indirection_map());
}

}  // namespace tessera
