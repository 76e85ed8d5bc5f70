// Virtual Indirection Map (3.2): "an aperiodic random number p is generated using grid index g as a seed
// value".
#include "server/blocks/draw_field.h"

namespace tessera {

Result<void> compile_virtual_indirection_map(Compilation& c, std::size_t block) {
    const proto::VirtualIndirectionMap& message = c.graph.blocks[block].message->virtual_indirection_map();
    if (message.count() < 1 || message.count() > 65536)
        return c.error(block, ".count", "is " + std::to_string(message.count()) + "; from 1 to 65536");
    auto node =
        make_draw(c, block, c.named(message.grid()), message.generator(), message.stream(), message.count());
    if (!node) return node.error();
    if (auto added = c.add_node(block, std::move(*node)); !added) return added.error();
    return {};
}

}  // namespace tessera
