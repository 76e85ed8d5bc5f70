#include <algorithm>
#include <array>
#include <cmath>

#include "server/filter/each_footprint.h"
#include "server/filter/lattice.h"
#include "server/filter/mip_probe.h"

namespace tessera {

namespace {

constexpr double greatest_ratio = 64;
constexpr int weights = 1024;

/// e^(−2r²) for r² in 1024ths: Taylor's series, no libm.
constexpr std::array<float, weights> make_weights() {
    std::array<float, weights> table{};
    for (int i = 0; i < weights; ++i) {
        const double x = -2.0 * (i + 0.5) / weights;
        double sum = 1;
        for (int n = 24; n > 0; --n) sum = 1 + sum * x / n;
        table[static_cast<std::size_t>(i)] = static_cast<float>(sum);
    }
    return table;
}
constexpr std::array<float, weights> weight_of = make_weights();

/// The elliptical weighted average (Greene and Heckbert, "Creating raster Omnimax images from multiple
/// perspective views using the elliptical weighted average filter", IEEE CG&A 6(6), 1986): a Gaussian over
/// the ellipse that a round pixel of twice the footprint's sides makes, on the level where its shorter radius
/// is one to two texels. Ellipses longer than 64 times their width are widened.
class EwaFilter {
  public:
    EwaFilter(const FootprintFilter&, std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : texels_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading) {
        // The quadratic form of the ellipse of the two axes: A·x² + B·x·y + C·y² < F
        const FootprintAxes axes = axes_of(footprint);
        const auto [ux, vx] = axes.major;
        const auto [uy, vy] = axes.minor;
        // In the plane of its own half axes: turned, its radii squared are the form's eigenvalues
        const double p = ux * ux + uy * uy, q = vx * vx + vy * vy, r = ux * vx + uy * vy;
        const double middle = (p + q) / 2, spread = std::sqrt((p - q) * (p - q) / 4 + r * r);
        const double longer = middle + spread, determinant = (ux * vy - uy * vx) * (ux * vy - uy * vx);
        const double shorter = longer > 0 ? determinant / longer : 0;
        const double narrow = std::max({shorter, longer / (greatest_ratio * greatest_ratio), 0x1p-40});
        const int level = narrow > 4 ? std::min(static_cast<int>(log2_of(narrow) / 2), int{max_level}) : 0;

        // Add what lacks to the shorter radius, and the texel's own width (Heckbert 1989, section 3.5.8)
        const double scale = halved(level);
        const double share = spread > 0 ? (narrow - shorter) / (2 * spread) : 0;
        const double wider = scale * scale;
        const double a = (p + share * (longer - p)) * wider + 1, c = (q + share * (longer - q)) * wider + 1,
                     b = (r - share * r) * wider;
        const double form = a * c - b * b;
        const double reach_y = std::sqrt(c);

        const LatticePoint at = lattice_point(footprint, axes.centre);
        const std::int64_t mask = (std::int64_t{1} << level) - 1;
        const std::int64_t x = at.x >> level, y = at.y >> level;
        const double in_x = (static_cast<double>(at.x & mask) + at.in_x) * scale - 0.5,
                     in_y = (static_cast<double>(at.y & mask) + at.in_y) * scale - 0.5;

        Doubles4 sum;
        double total = 0;
        const double by = weights / form;
        for (std::int64_t j = floor_of(in_y - reach_y) + 1; static_cast<double>(j) <= in_y + reach_y; ++j) {
            // Where the row enters and leaves the ellipse
            const double dy = static_cast<double>(j) - in_y;
            const double root = form * (c - dy * dy);
            if (!(root > 0)) continue;
            const double half = std::sqrt(root) / c, centre = in_x + b * dy / c;
            const std::int64_t last = floor_of(centre + half);
            for (std::int64_t i = floor_of(centre - half) + 1; i <= last;) {
                const std::int64_t end = std::min(last, ((x + i) | 255) - x);  // Of the page
                const std::uint16_t* texel = texels_.at(level, (x + i) >> 8, (y + j) >> 8, reading)
                                                 .texel((x + i) & 255, (y + j) & 255);
                for (; i <= end; ++i, texel += 4) {
                    const double dx = static_cast<double>(i) - in_x;
                    const auto square =
                        static_cast<std::int32_t>((c * dx * dx - 2 * b * dx * dy + a * dy * dy) * by);
                    const double weight = static_cast<double>(
                        weight_of[static_cast<std::size_t>(std::clamp(square, 0, weights - 1))]);
                    sum += Doubles4{load_steps(texel)} * weight;
                    total += weight;
                    ++reading.texels;
                }
            }
        }
        const Doubles4 steps = sum * (1 / total);
        return {steps, bound_of_any(steps)};
    }

  private:
    PageTables<TexelRows> texels_;
};

}  // namespace

std::unique_ptr<FootprintSampler> make_ewa(const FootprintFilter& filter,
                                           std::shared_ptr<const TexelPages> pages,
                                           std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<EwaFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
