#include "server/filter/each_footprint.h"
#include "server/filter/mip_probe.h"

namespace tessera {

namespace {

/// The four texels of level 0 around the middle of the footprint, as a GPU magnifies.
class BilinearFilter {
  public:
    BilinearFilter(const FootprintFilter&, std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : probe_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading) {
        const Doubles4 steps{
            probe_.bilinear(0, lattice_point(footprint, axes_of(footprint).centre), reading)};
        return {steps, probe_.bound_of_four(footprint, steps)};
    }

  private:
    MipProbe probe_;
};

}  // namespace

std::unique_ptr<FootprintSampler> make_bilinear(const FootprintFilter& filter,
                                                std::shared_ptr<const TexelPages> pages,
                                                std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<BilinearFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
