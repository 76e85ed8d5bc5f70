#include "server/texture/typed_quadtree.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "shared/math/hash.h"

namespace tessera {

TypedQuadtree::TypedQuadtree(std::uint64_t seed, std::uint32_t types, int below)
    : seed_{seed}, types_{types}, below_{below}, top_{root_height + below} {
    std::vector<std::uint16_t> deck(std::size_t{types} * 4);
    children_.resize(std::size_t{types} * static_cast<std::size_t>(top_));
    for (int height = 1; height <= top_; ++height) {
        // Shuffle a deck that holds every type four times (Fisher and Yates)
        const int of_seed = height - below;
        const std::uint64_t key = of_seed > 0
                                      ? stream("typed quadtree", static_cast<std::uint64_t>(of_seed))
                                      : stream("typed quadtree below", static_cast<std::uint64_t>(-of_seed));
        for (std::size_t i = 0; i < deck.size(); ++i) {
            const std::uint32_t j = uniform_below(hash(seed, key, static_cast<std::int64_t>(i), 0),
                                                  static_cast<std::uint32_t>(i) + 1);
            deck[i] = deck[j];
            deck[j] = static_cast<std::uint16_t>(i / 4);
        }
        for (std::size_t type = 0; type < types; ++type)
            for (std::size_t child = 0; child < 4; ++child)
                children_[static_cast<std::size_t>(height - 1) * types + type][child] =
                    deck[type * 4 + child];
    }
    // −1 is the last child of its parent, which is −1 again; 0 is the first one
    origin_.resize(static_cast<std::size_t>(top_) + 1);
    for (std::size_t quadrant = 0; quadrant < 4; ++quadrant) {
        std::uint16_t type = root((quadrant & 1) != 0 ? -1 : 0, (quadrant & 2) != 0 ? -1 : 0, 0);
        for (int height = top_;; --height) {
            origin_[static_cast<std::size_t>(height)][quadrant] = type;
            if (height == 0) break;
            type = children(height, type)[quadrant];
        }
    }
}

std::uint16_t TypedQuadtree::root(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
    std::uint64_t roots = stream("typed quadtree roots");
    if (z != 0) roots = mix(roots + 0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(z));
    return static_cast<std::uint16_t>(uniform_below(hash(seed_, roots, x, y), types_));
}

TypedQuadtree::Square TypedQuadtree::square_at(std::int64_t x, std::int64_t y, int across,
                                               int down) const noexcept {
    Square square;
    // Neighbours mostly have one parent not far above: one path down to it, then one for each of them
    const auto apart = static_cast<std::uint64_t>((x ^ (x + across)) | (y ^ (y + down)));
    const auto common = static_cast<int>(std::bit_width(apart));
    const bool one_root = common <= top_;
    const int from = origin_height(x, y);
    const std::uint16_t shared = !one_root     ? std::uint16_t{0}
                                 : from > top_ ? descend(root(x >> top_, y >> top_, 0), top_, common, x, y)
                                               : descend(under_origin(std::max(from, common), x, y),
                                                         std::max(from, common), common, x, y);
    for (int v = 0; v <= down; ++v)
        for (int u = 0; u <= across; ++u)
            square.at[std::size_t(v)][std::size_t(u)] =
                one_root ? descend(shared, common, 0, x + u, y + v)
                         : descend(root((x + u) >> top_, (y + v) >> top_, 0), top_, 0, x + u, y + v);
    return square;
}

void write_children(const TypeGrid& parents, const std::array<std::uint16_t, 4>* families, std::int64_t x,
                    std::int64_t y, std::int64_t width, std::int64_t height, TypeGrid& children) {
    children.x = x & ~std::int64_t{1};
    children.y = y & ~std::int64_t{1};
    children.width = static_cast<std::int32_t>(((x + width - 1) | 1) - children.x + 1);
    children.height = static_cast<std::int32_t>(((y + height - 1) | 1) - children.y + 1);
    children.types.resize(std::size_t(children.width) * std::size_t(children.height));
    for (std::int32_t row = 0; row < children.height; row += 2) {
        const std::uint16_t* above = parents.row((children.y + row) >> 1) + ((children.x >> 1) - parents.x);
        std::uint16_t* upper = children.types.data() + std::ptrdiff_t(row) * children.width;
        std::uint16_t* lower = upper + children.width;
        for (std::int32_t column = 0; column < children.width; column += 2) {
            const auto& family = families[above[column >> 1]];
            upper[column] = family[0];
            upper[column + 1] = family[1];
            lower[column] = family[2];
            lower[column + 1] = family[3];
        }
    }
}

TypeGrid TypedQuadtree::types_of(int height, std::int64_t x, std::int64_t y, std::int32_t width,
                                 std::int32_t height_nodes, std::int64_t z) const {
    // The nodes over the rectangle at each height, from the roots down
    const auto rectangle_at = [&](int at_height) {
        const int up = at_height - height;
        TypeGrid grid;
        grid.x = x >> up;  // arithmetic: rounds towards −∞, as a lattice needs
        grid.y = y >> up;
        grid.width = static_cast<std::int32_t>(((x + width - 1) >> up) - grid.x + 1);
        grid.height = static_cast<std::int32_t>(((y + height_nodes - 1) >> up) - grid.y + 1);
        return grid;
    };

    TypeGrid grid = rectangle_at(top_), below;
    // Two grids take turns, each as large as it will ever be
    grid.types.reserve(std::size_t(width + 2) * std::size_t(height_nodes + 2));
    below.types.reserve(grid.types.capacity());
    for (std::int64_t row = 0; row < grid.height; ++row)
        for (std::int64_t column = 0; column < grid.width; ++column)
            grid.types.push_back(root(grid.x + column, grid.y + row, z));

    int at_height = top_;
    if (grid.types.size() == 1) {
        // One path as long as one node holds all: most of the way, and for one texel all of it
        std::uint16_t type = grid.types.front();
        for (; at_height > height; --at_height) {
            const int up = at_height - 1 - height;
            const std::int64_t node_x = x >> up, node_y = y >> up;
            if (node_x != (x + width - 1) >> up || node_y != (y + height_nodes - 1) >> up) break;
            type = children(at_height, type)[static_cast<std::size_t>((node_x & 1) | (node_y & 1) << 1)];
        }
        const int up = at_height - height;
        grid.x = x >> up;
        grid.y = y >> up;
        grid.types.front() = type;
    }
    for (; at_height > height; --at_height) {
        const int up = at_height - 1 - height;
        const std::int64_t first_x = x >> up, first_y = y >> up;
        write_children(grid, &children_[static_cast<std::size_t>(at_height - 1) * types_], first_x, first_y,
                       ((x + width - 1) >> up) - first_x + 1, ((y + height_nodes - 1) >> up) - first_y + 1,
                       below);
        std::swap(grid, below);
    }
    return grid;
}

}  // namespace tessera
