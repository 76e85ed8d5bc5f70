#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/texture/typed_quadtree.h"

namespace tessera {

/// The typed quadtree over choosing units, which may keep apart what is alike: a unit's type is of one of 64
/// classes, and units that lie near each other under one node are of different ones. Then they show nothing
/// that only one class may show.
///
/// Nodes up to a height h have classes, too: type mod 64 / 4^height. A node of class q of height `apart` or
/// less has one child of each of the classes 4q to 4q + 3, in some order. So the 4^apart units under a node
/// of height `apart` are of different classes, and which ones, its own class says. As in the typed quadtree
/// every type is equally frequent at every height: of each class its own deck is shuffled and dealt. A node's
/// height and type decide all that lies under it as ever.
class UnitTree {
  public:
    static constexpr std::uint32_t classes = 64;

    /// `types`: as for TypedQuadtree; `apart`: 0 (any unit beside any other) to 2.
    UnitTree(std::uint64_t seed, std::uint32_t types, int apart = 0);

    std::uint32_t types() const noexcept { return blocks_.types(); }
    /// As TypedQuadtree's; heights count from units on.
    const std::array<std::uint16_t, 4>& children(int height, std::uint16_t type) const noexcept {
        return height > apart_ ? blocks_.children(height - apart_, type)
                               : children_[static_cast<std::size_t>(height - 1) * types() + type];
    }
    TypeGrid types_of(int height, std::int64_t x, std::int64_t y, std::int32_t width,
                      std::int32_t height_nodes) const;
    TypedQuadtree::Square square_at(std::int64_t x, std::int64_t y, int across, int down) const noexcept;

    std::size_t memory_bytes() const noexcept {
        return blocks_.memory_bytes() + children_.size() * sizeof children_[0];
    }

  private:
    /// The type of the node of `height` over (x, y), under one of height apart_ of that type.
    std::uint16_t descend(std::uint16_t type, int height, std::int64_t x, std::int64_t y) const noexcept {
        for (int at = apart_; at > height; --at) {
            const int up = at - 1 - height;
            type = children(at, type)[static_cast<std::size_t>(((x >> up) & 1) | ((y >> up) & 1) << 1)];
        }
        return type;
    }

    int apart_;
    TypedQuadtree blocks_;                                ///< Its leaves are nodes of height apart_.
    std::vector<std::array<std::uint16_t, 4>> children_;  ///< [height − 1][type], up to apart_.
};

}  // namespace tessera
