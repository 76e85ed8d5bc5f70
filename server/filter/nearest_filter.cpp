#include "server/filter/each_footprint.h"
#include "server/filter/lattice.h"

namespace tessera {

namespace {

/// The texel of level 0 under the middle of the footprint.
class NearestFilter {
  public:
    NearestFilter(const FootprintFilter&, std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : texels_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading) {
        const LatticePoint at = lattice_point(footprint, axes_of(footprint).centre);
        const Doubles4 steps{
            load_steps(texels_.at(0, at.x >> 8, at.y >> 8, reading).texel(at.x & 255, at.y & 255))};
        reading.texels = 1;
        // A footprint inside the texel has its colour and no other
        const FootprintBox box = box_of(footprint);
        const bool inside =
            floor_of(box.left) == floor_of(box.right) && floor_of(box.top) == floor_of(box.bottom);
        return {steps, inside ? 0.0 : bound_of_any(steps)};
    }

  private:
    PageTables<TexelRows> texels_;
};

}  // namespace

std::unique_ptr<FootprintSampler> make_nearest(const FootprintFilter& filter,
                                               std::shared_ptr<const TexelPages> pages,
                                               std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<NearestFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
