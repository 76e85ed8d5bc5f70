// Textures that are no patterns: one colour, and prepared photographs as a ground.
#include "server/blocks/compilation.h"
#include "server/texture/constant_texture.h"

namespace tessera {

Result<void> compile_given(Compilation& c, std::size_t block) {
    const proto::Block& message = *c.graph.blocks[block].message;
    GivenPlan plan;
    if (message.block_case() == proto::Block::kConstant) {
        const proto::Color& color = message.constant();
        const struct {
            std::string_view field;
            std::uint32_t code;
        } codes[] = {{".constant.red", color.red()},
                     {".constant.green", color.green()},
                     {".constant.blue", color.blue()},
                     {".constant.alpha", color.has_alpha() ? color.alpha() : 255}};
        for (const auto& [field, code] : codes)
            if (code > 255) return c.error(block, field, "is " + std::to_string(code) + "; from 0 to 255");
        plan.texture = make_constant_texture(
            {static_cast<std::uint8_t>(codes[0].code), static_cast<std::uint8_t>(codes[1].code),
             static_cast<std::uint8_t>(codes[2].code), static_cast<std::uint8_t>(codes[3].code)});
    } else {
        auto texture = c.files.read_exchange(
            c.graph.blocks[block].path + "." + std::string{c.graph.blocks[block].kind}, message);
        if (!texture) return texture.error();
        plan.texture = std::move(*texture);
    }
    c.blocks[block].texture = c.plan.textures.size();
    c.plan.textures.push_back({message.name(), std::move(plan)});
    return {};
}

}  // namespace tessera
