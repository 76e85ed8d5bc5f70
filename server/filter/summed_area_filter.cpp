#include <algorithm>
#include <cmath>

#include "server/filter/each_footprint.h"
#include "server/filter/lattice.h"
#include "server/filter/summed_area.h"

namespace tessera {

namespace {

constexpr double most_side = 512;
/// Narrower boxes are widened, so that four great sums keep their difference.
constexpr double least_side = 1.0 / 32;

/// A page's sums. They stay below 2^32: 65536 texels of 65535 steps.
struct PageSums {
    static constexpr std::size_t bytes = SummedArea::bytes(page_side_texels, page_side_texels);

    explicit PageSums(const TexelPage& page) : sums{page_side_texels, page_side_texels} {
        for (std::int32_t y = 0; y < page_side_texels; ++y)
            sums.set_row(y, page.steps.data() + std::ptrdiff_t{4} * page_side_texels * y);
    }

    /// Of all that lies above and left of a point of the page, where a part of a texel counts as that part.
    Doubles4 before(double x, double y) const noexcept {
        const auto i = std::min(static_cast<std::int32_t>(x), page_side_texels - 1),
                   j = std::min(static_cast<std::int32_t>(y), page_side_texels - 1);
        const std::uint32_t *upper = sums.line(j) + 4 * i, *lower = sums.line(j + 1) + 4 * i;
        const double u = x - i, v = y - j;
        const Doubles4 above = four(upper) * (1 - u) + four(upper + 4) * u;
        return above * (1 - v) + (four(lower) * (1 - u) + four(lower + 4) * u) * v;
    }

    static Doubles4 four(const std::uint32_t* entry) noexcept {
        return {Doubles2{static_cast<double>(entry[0]), static_cast<double>(entry[1])},
                Doubles2{static_cast<double>(entry[2]), static_cast<double>(entry[3])}};
    }

    SummedArea sums;
};

/// The box around the footprint, from a summed-area table (Crow, "Summed-area tables for texture mapping",
/// SIGGRAPH 1984) of each page that it meets. Boxes of more than 512 texels take those of a coarser level.
class SummedAreaFilter {
  public:
    SummedAreaFilter(const FootprintFilter&, std::shared_ptr<const TexelPages> pages,
                     std::size_t memory_bytes)
        : tables_{std::move(pages), memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading) {
        FootprintBox box = box_of(footprint);
        const double whole_width = box.width(), whole_height = box.height();
        widen(box.left, box.right);
        widen(box.top, box.bottom);
        const int level = level_of_at_most(std::max(box.width(), box.height()), most_side);

        // In texels of the level, from the corner of the first page
        const LocalFrame frame{footprint, box, level, level + 8};
        const double x0 = frame.across(box.left), x1 = frame.across(box.right), y0 = frame.down(box.top),
                     y1 = frame.down(box.bottom);
        constexpr double side = page_side_texels;
        Doubles4 sum;
        for (std::int64_t j = 0; static_cast<double>(j) * side < y1; ++j)
            for (std::int64_t i = 0; static_cast<double>(i) * side < x1; ++i) {
                const double u = static_cast<double>(i) * side, v = static_cast<double>(j) * side;
                const PageSums& table = tables_.at(level, frame.x + i, frame.y + j, reading);
                const double from_x = std::max(x0 - u, 0.0), to_x = std::min(x1 - u, side),
                             from_y = std::max(y0 - v, 0.0), to_y = std::min(y1 - v, side);
                sum += table.before(to_x, to_y) - table.before(from_x, to_y) -
                       (table.before(to_x, from_y) - table.before(from_x, from_y));
                reading.texels += 16;
            }
        Estimate estimate{sum * (1 / ((x1 - x0) * (y1 - y0)))};
        const double area = area_of(footprint);
        const bool as_it_is = whole_width >= least_side && whole_height >= least_side && level == 0;
        estimate.bound_codes = as_it_is ? bound_of_part(estimate.steps, area / (whole_width * whole_height))
                                        : bound_of_any(estimate.steps);
        return estimate;
    }

  private:
    static void widen(double& from, double& to) noexcept {
        if (to - from >= least_side) return;
        const double middle = (from + to) / 2;
        from = middle - least_side / 2;
        to = middle + least_side / 2;
    }

    /// A part `share` of a box of average m averages between max(0, (share + m − 1)/share) and
    /// min(1, m/share).
    static double bound_of_part(const Doubles4& steps, double share) noexcept {
        share = std::clamp(share, 0x1p-40, 1.0);
        double bound = 0;
        for (int c = 0; c < 4; ++c) {
            const double m = steps[c] / 65535;
            bound =
                std::max({bound, m - std::max(0.0, (share + m - 1) / share), std::min(1.0, m / share) - m});
        }
        return bound * 255 + 1e-6;
    }

    PageTables<PageSums> tables_;
};

}  // namespace

std::unique_ptr<FootprintSampler> make_summed_area(const FootprintFilter& filter,
                                                   std::shared_ptr<const TexelPages> pages,
                                                   std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<SummedAreaFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
