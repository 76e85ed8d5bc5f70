#pragma once

#include <cstdint>
#include <memory>

#include "server/blocks/cell_program.h"
#include "server/pattern/chance_bounds.h"
#include "server/pattern/look_means.h"
#include "server/texture/texture.h"

namespace tessera {

/// What texels of many cells are expected to show, where the cells' looks are drawn: the mean of the looks'
/// colours by their probabilities, averaged over the texel's very cells. Where a map shifts the probabilities
/// over the plane this is exact too: box sums of the map, of the bilinear mixtures that dithering draws, and
/// of the polynomials that transition tiles make of those.
class AreaExpectation {
  public:
    virtual ~AreaExpectation() = default;

    /// Texels of `region` of level cell level + `up`, 1 or more: of 2^up × 2^up cells. Its bound is on the
    /// distance to the texture as drawn. `out` is of the region's size.
    /// `shift`: of cells so far to the right; a multiple of 8 entries of the map, if there is one.
    virtual Result<Evaluation> evaluate(const TexelRegion& region, int up, const Budget& budget,
                                        LinearImage& out, std::int64_t shift = 0) const = 0;
    /// Whether all texels are one colour.
    virtual bool uniform() const noexcept { return false; }
    /// No texel of 2^up × 2^up cells is further from what is drawn, anywhere.
    virtual ChanceBound bound(int up) const noexcept = 0;
    virtual std::size_t memory_bytes() const noexcept = 0;
};

/// `means`: of a slice's looks. `uneven`: how much of the shares may lie elsewhere, which widens chance but
/// is not in the bound itself. Null where the looks cannot be listed (Basis::other, or too many states), and
/// for typed ones, whose sums are exact. `program` lives as long as the result.
std::unique_ptr<const AreaExpectation> make_area_expectation(const CellProgram& program,
                                                             const LookMeans& means, std::int32_t slice,
                                                             double uneven = 0);

/// The most that the expectation of one slice may take, in bytes.
std::uint64_t area_expectation_bytes(const CellProgram& program);

}  // namespace tessera
