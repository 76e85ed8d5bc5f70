#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/blocks/plan.h"
#include "server/pattern/pattern_mips.h"
#include "server/pattern/pattern_texture.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// What the cells of a typed texture look like: one image for each type of the grid's quadtree.
class TypeImages {
  public:
    virtual ~TypeImages() = default;
    /// The image of `type` at `level` (0 to grid.cell_log2), (cell side >> level)² texels, linear and
    /// premultiplied: at every level the exact box reduction of level 0. `slice` is inside the cell, 0
    /// without a third dimension.
    virtual void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const = 0;
    /// How many slices there are before they repeat, where the grid's cells are not 3D: 1 without a third
    /// dimension. Where they are, a slice below grid.cell_slices is asked for.
    virtual std::int32_t slices() const noexcept { return 1; }
    virtual std::size_t memory_bytes() const noexcept = 0;
    virtual std::string description() const = 0;
};

/// A texture whose cells are each one of T images, exact at every level (DESIGN section 2, "Choices"). Images
/// of levels where all types together take little memory are kept; at finer ones a page draws the cells that
/// it meets. Above the cell, means are tabulated for each height and type. `grid.quadtree` is set.
std::shared_ptr<const PatternTexture> make_typed_texture(const Grid& grid,
                                                         std::shared_ptr<const TypeImages> images);

/// The same where a cell of type t shows the pattern of that index (−1: nothing) and is as large as it:
/// pages are then copies of the patterns' rows. `pattern_of_type` has an entry for each type.
std::shared_ptr<const PatternTexture> make_typed_texture(const Grid& grid,
                                                         std::shared_ptr<const PatternMips> patterns,
                                                         std::vector<std::int32_t> pattern_of_type);

}  // namespace tessera
