#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

/// Types of a rectangle of nodes of one height, rows from the top.
struct TypeGrid {
    std::int64_t x = 0;  ///< The first column's and row's node coordinates.
    std::int64_t y = 0;
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint16_t> types;

    const std::uint16_t* row(std::int64_t node_y) const noexcept {
        return types.data() + (node_y - y) * width;
    }
    std::uint16_t at(std::int64_t node_x, std::int64_t node_y) const noexcept {
        return row(node_y)[node_x - x];
    }
};

/// The nodes of the next lower height that hold at least [x, x + width) × [y, y + height), written over
/// `children`: whole families, so that there may be a node more on each side. `parents` holds all their
/// parents; `families` has the children of each type there: left and right, then below.
void write_children(const TypeGrid& parents, const std::array<std::uint16_t, 4>* families, std::int64_t x,
                    std::int64_t y, std::int64_t width, std::int64_t height, TypeGrid& children);

/// The typed quadtree of DESIGN section 2 over the infinite lattice of choosing units. A node of height h
/// covers 2^h × 2^h units and has one of T types; height and type decide the types of its four children, so
/// that all that lies under a node is a function of (height, type) and can be tabulated once.
///
/// Departure from DESIGN, which hashes a child's type: for each height the 4T children are a shuffled deck
/// that holds every type exactly four times. All types are then equally frequent at every height, and a
/// table's mean over its types is the texture's mean with no sampling error. Integers only; random access; no
/// state.
class TypedQuadtree {
  public:
    /// Roots lie above any extent: 2^36 units of at least 16 texels are 2^40 texels. Beyond, roots are
    /// hashed.
    static constexpr int root_height = 36;

    /// `types`: T, a power of two from 64 to 16384. `below`: where this tree's leaves lie in the tree of that
    /// seed: so many heights below its leaves, or, negative, above them, 12 at most. Trees of one seed and as
    /// many types are then one tree, looked at from units of different size.
    TypedQuadtree(std::uint64_t seed, std::uint32_t types, int below = 0);

    std::uint32_t types() const noexcept { return types_; }
    /// The same tree, with leaves `heights` above (or, negative, below) these.
    TypedQuadtree lifted(int heights) const { return {seed_, types_, below_ - heights}; }
    /// Whether `other` is this tree, with leaves so many heights above.
    bool is_lifted(const TypedQuadtree& other, int heights) const noexcept {
        return seed_ == other.seed_ && types_ == other.types_ && below_ - heights == other.below_;
    }

    /// Types of the children of a node of `height` (1 to root_height, more or less by `below`): top-left,
    /// top-right, bottom-left, bottom-right.
    const std::array<std::uint16_t, 4>& children(int height, std::uint16_t type) const noexcept {
        return children_[static_cast<std::size_t>(height - 1) * types_ + type];
    }

    /// The types of at least the nodes [x, x + width) × [y, y + height_nodes) of `height` (from 0 on);
    /// the grid may be a node larger on each side. Walks the tree once: about 4/3 look-ups a node. `z` names
    /// the layer of units, where there is a third dimension: each has roots of its own.
    TypeGrid types_of(int height, std::int64_t x, std::int64_t y, std::int32_t width,
                      std::int32_t height_nodes, std::int64_t z = 0) const;

    /// The types of the leaves (x, y) to (x + across, y + down); across and down are 0 or 1. As types_of(),
    /// without any allocation.
    struct Square {
        std::array<std::array<std::uint16_t, 2>, 2> at{};  ///< [down][across]
    };
    Square square_at(std::int64_t x, std::int64_t y, int across, int down) const noexcept;

    /// The same for trees that are the same.
    std::string name() const {
        return std::to_string(seed_) + '/' + std::to_string(types_) + '/' + std::to_string(below_);
    }

    std::size_t memory_bytes() const noexcept { return children_.size() * sizeof children_[0]; }

  private:
    std::uint16_t root(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept;
    /// The lowest height at which the leaf of layer 0 lies under one of the four nodes that meet in the
    /// origin.
    int origin_height(std::int64_t x, std::int64_t y) const noexcept {
        return static_cast<int>(
            std::bit_width(static_cast<std::uint64_t>((x ^ (x >> 63)) | (y ^ (y >> 63)))));
    }
    /// The type of that node, of this height or a greater one.
    std::uint16_t under_origin(int height, std::int64_t x, std::int64_t y) const noexcept {
        return origin_[static_cast<std::size_t>(height)][(x < 0 ? 1u : 0u) | (y < 0 ? 2u : 0u)];
    }
    /// The type of the node of `height` over the leaf, from that of the node of `from` on.
    std::uint16_t descend(std::uint16_t type, int from, int height, std::int64_t x,
                          std::int64_t y) const noexcept {
        while (from > height) {
            const int up = from - 1;
            type = children(from--, type)[static_cast<std::size_t>(((x >> up) & 1) | ((y >> up) & 1) << 1)];
        }
        return type;
    }

    std::uint64_t seed_;
    std::uint32_t types_;
    int below_;
    int top_;                                             ///< The roots' height, counted from these leaves.
    std::vector<std::array<std::uint16_t, 4>> children_;  ///< [height − 1][type]
    /// For each height the types of the four nodes that meet in the origin: what any extent lies under needs
    /// no walk from the roots.
    std::vector<std::array<std::uint16_t, 4>> origin_;
};

}  // namespace tessera
