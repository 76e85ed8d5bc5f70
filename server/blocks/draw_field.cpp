#include "server/blocks/draw_field.h"

namespace tessera {

Result<CellNode> make_draw(Compilation& c, std::size_t block, std::size_t grid, Generator generator,
                           std::uint32_t stream, std::uint32_t count) {
    if (!proto::Draw::Generator_IsValid(generator))
        return c.error(
            block, ".generator",
            "is " + std::to_string(generator) + "; automatic, typed, independent, nested or sigma");
    CellNode node;
    node.grid = grid;
    node.draw = CellDraw{generator, c.stream_key(block, stream, grid), count};
    node.most = static_cast<std::int32_t>(count - 1);
    return node;
}

}  // namespace tessera
