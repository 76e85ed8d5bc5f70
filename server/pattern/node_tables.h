#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/texture/typed_quadtree.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// What all that lies under a node of a typed quadtree looks like, for each type and for every height that a
/// page may ask for: a function of (height, type), tabulated once from the cells up (DESIGN section 2).
class CellNodeTables {
  public:
    /// Of every type, in its order: `means`, the cell's mean colour, and `quarters`, its image at the level
    /// where it is 2×2 texels (four texels from the top left; empty where the cell is one texel).
    CellNodeTables(const TypedQuadtree& quadtree, int cell_log2, std::vector<std::array<double, 4>> means,
                   std::vector<float> quarters);

    /// The finest level that the tables hold: where a cell is 2×2 texels, or 0.
    int first_level() const noexcept { return cell_log2_ > 0 ? cell_log2_ - 1 : 0; }

    /// Small images, one for each type of the nodes of `height`: side 2^side_log2 texels, image after image.
    template <class Texel>
    struct Images {
        const Texel* texels;  ///< Four a texel.
        int side_log2;
        int height;
    };
    Images<float> linear(int level) const noexcept;
    /// 4×4 texels: one line of cache for sixteen nodes or quarters of cells.
    Images<std::uint8_t> codes(int level) const noexcept;

    std::size_t memory_bytes() const noexcept;

  private:
    int cell_log2_;
    std::vector<float> quarters_;
    std::vector<std::vector<float>> means_;          ///< [height]
    std::vector<std::vector<std::uint8_t>> blocks_;  ///< [level − first_level()]
};

}  // namespace tessera
