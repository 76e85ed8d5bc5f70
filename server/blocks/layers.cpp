// Layers: the combinations of section 4 that lie on top of each other, premultiplied over.
#include "server/blocks/compilation.h"

namespace tessera {

Result<void> compile_layers(Compilation& c, std::size_t block) {
    const proto::Layers& message = c.graph.blocks[block].message->layers();
    if (message.textures().empty() || message.textures_size() > 64)
        return c.error(block, ".textures",
                       "lists " + std::to_string(message.textures_size()) + " textures; from 1 to 64");
    auto textures = c.shown(block, message.textures());
    if (!textures) return textures.error();
    LayersPlan plan{std::move(*textures)};
    c.notes[block] = std::to_string(plan.textures.size()) + " layers";
    c.blocks[block].texture = c.plan.textures.size();
    c.plan.textures.push_back({c.graph.blocks[block].message->name(), std::move(plan)});
    return {};
}

}  // namespace tessera
