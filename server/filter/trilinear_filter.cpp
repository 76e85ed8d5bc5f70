#include "server/filter/each_footprint.h"
#include "server/filter/mip_probe.h"

namespace tessera {

namespace {

/// Isotropic MIP mapping (Williams, "Pyramidal parametrics", SIGGRAPH 1983), the level by the longer axis of
/// the footprint as OpenGL chooses it.
class TrilinearFilter {
  public:
    TrilinearFilter(const FootprintFilter&, std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : probe_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading) {
        const FootprintAxes axes = axes_of(footprint);
        const double square = axes.major.x * axes.major.x + axes.major.y * axes.major.y;
        const double lod = square > 1 ? log2_of(square) / 2 : 0;
        const Doubles4 steps{probe_.trilinear(lod, lattice_point(footprint, axes.centre), reading)};
        return {steps, lod > 0 ? bound_of_any(steps) : probe_.bound_of_four(footprint, steps)};
    }

  private:
    MipProbe probe_;
};

}  // namespace

std::unique_ptr<FootprintSampler> make_trilinear(const FootprintFilter& filter,
                                                 std::shared_ptr<const TexelPages> pages,
                                                 std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<TrilinearFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
