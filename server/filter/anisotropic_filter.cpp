#include <algorithm>
#include <cmath>

#include "server/filter/each_footprint.h"
#include "server/filter/mip_probe.h"

namespace tessera {

namespace {

/// Trilinear probes along the longer axis, by the formula of EXT_texture_filter_anisotropic:
/// N = min(⌈Pmax/Pmin⌉, most), λ = log2(Pmax/N), probes at −½ + i/(N + 1) of the axis, i = 1 … N.
class AnisotropicFilter {
  public:
    AnisotropicFilter(const FootprintFilter& filter, std::shared_ptr<const TexelPages> pages,
                      std::size_t memory_bytes)
        : most_{std::clamp(filter.probes, 1, 64)}, probe_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading) {
        const FootprintAxes axes = axes_of(footprint);
        const double longer = std::sqrt(axes.major.x * axes.major.x + axes.major.y * axes.major.y);
        const double shorter = std::sqrt(axes.minor.x * axes.minor.x + axes.minor.y * axes.minor.y);
        const int probes = longer <= shorter           ? 1
                           : longer >= shorter * most_ ? most_
                                                       : static_cast<int>(std::ceil(longer / shorter));
        const double step = longer / probes;
        const double lod = step > 1 ? log2_of(step) : 0;
        Floats4 sum{};
        for (int i = 1; i <= probes; ++i) {
            const double along = static_cast<double>(i) / (probes + 1) - 0.5;
            const TexelPoint at{axes.centre.x + along * axes.major.x, axes.centre.y + along * axes.major.y};
            sum += probe_.trilinear(lod, lattice_point(footprint, at), reading);
        }
        const Doubles4 steps = Doubles4{sum} * (1.0 / probes);
        const bool magnified = probes == 1 && lod == 0;
        return {steps, magnified ? probe_.bound_of_four(footprint, steps) : bound_of_any(steps)};
    }

  private:
    int most_;
    MipProbe probe_;
};

}  // namespace

std::unique_ptr<FootprintSampler> make_anisotropic(const FootprintFilter& filter,
                                                   std::shared_ptr<const TexelPages> pages,
                                                   std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<AnisotropicFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
