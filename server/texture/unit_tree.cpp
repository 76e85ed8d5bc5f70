#include "server/texture/unit_tree.h"

#include <utility>

#include "shared/math/hash.h"

namespace tessera {

UnitTree::UnitTree(std::uint64_t seed, std::uint32_t types, int apart)
    : apart_{apart}, blocks_{seed, types}, children_(std::size_t{types} * static_cast<std::size_t>(apart)) {
    for (int height = 1; height <= apart; ++height) {
        const auto key = stream("units apart", static_cast<std::uint64_t>(height));
        const std::uint32_t below = classes >> (2 * height - 2), own = below / 4;
        auto* const families = &children_[static_cast<std::size_t>(height - 1) * types];
        std::int64_t draw = 0;
        const auto swap_with = [&](std::uint32_t i) {
            return uniform_below(hash(seed, key, draw++, 0), i + 1);
        };
        // The types of one class of children, each four times, are dealt to the parents of a class, one each
        std::vector<std::uint16_t> deck(std::size_t{types} / below * 4);
        for (std::uint32_t of = 0; of < below; ++of) {
            for (std::uint32_t i = 0; i < deck.size(); ++i) {
                const std::uint32_t j = swap_with(i);
                deck[i] = deck[j];
                deck[j] = static_cast<std::uint16_t>(of + i / 4 * below);
            }
            for (std::uint32_t i = 0; i < deck.size(); ++i) families[of / 4 + i * own][of % 4] = deck[i];
        }
        for (std::uint32_t type = 0; type < types; ++type)
            for (std::uint32_t child = 1; child < 4; ++child)
                std::swap(families[type][child], families[type][swap_with(child)]);
    }
}

TypeGrid UnitTree::types_of(int height, std::int64_t x, std::int64_t y, std::int32_t width,
                            std::int32_t height_nodes) const {
    if (height >= apart_) return blocks_.types_of(height - apart_, x, y, width, height_nodes);
    const auto first_at = [&](std::int64_t first, int at) { return first >> (at - height); };
    const auto count_at = [&](std::int64_t first, std::int32_t count, int at) {
        return ((first + count - 1) >> (at - height)) - first_at(first, at) + 1;
    };
    TypeGrid grid = blocks_.types_of(0, first_at(x, apart_), first_at(y, apart_),
                                     static_cast<std::int32_t>(count_at(x, width, apart_)),
                                     static_cast<std::int32_t>(count_at(y, height_nodes, apart_)));
    TypeGrid below;
    for (int at = apart_; at > height; --at) {
        write_children(grid, &children_[static_cast<std::size_t>(at - 1) * types()], first_at(x, at - 1),
                       first_at(y, at - 1), count_at(x, width, at - 1), count_at(y, height_nodes, at - 1),
                       below);
        std::swap(grid, below);
    }
    return grid;
}

TypedQuadtree::Square UnitTree::square_at(std::int64_t x, std::int64_t y, int across,
                                          int down) const noexcept {
    if (apart_ == 0) return blocks_.square_at(x, y, across, down);
    const std::int64_t block_x = x >> apart_, block_y = y >> apart_;
    const TypedQuadtree::Square blocks =
        blocks_.square_at(block_x, block_y, static_cast<int>(((x + across) >> apart_) - block_x),
                          static_cast<int>(((y + down) >> apart_) - block_y));
    TypedQuadtree::Square square;
    for (int v = 0; v <= down; ++v)
        for (int u = 0; u <= across; ++u)
            square.at[std::size_t(v)][std::size_t(u)] =
                descend(blocks.at[std::size_t(((y + v) >> apart_) - block_y)]
                                 [std::size_t(((x + u) >> apart_) - block_x)],
                        0, x + u, y + v);
    return square;
}

}  // namespace tessera
