#include "client/residency/footprint_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace tessera {
namespace {

constexpr int block_pixels = 16;

struct Range {
    double low = 0, high = 0;
};

using Quadrilateral = std::array<GroundPoint, 4>;

class Blocks {
  public:
    Blocks(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling)
        : view_{view}, extent_{extent}, lod_bias_{lod_bias}, sampling_{sampling} {}

    std::vector<NeededPage> run() {
        // Rows whose middles lie below the horizon: it is level
        int first_row = 0;
        while (first_row < view_.height() && !view_.ground_at(0.5, first_row + 0.5)) ++first_row;
        for (int y = first_row; y < view_.height();) {
            // Near the horizon a row's level differs from the next one's
            const int rows = std::clamp((y - first_row) / 2, 1, block_pixels);
            const int below = std::min(y + rows, view_.height());
            for (int x = 0; x < view_.width(); x += block_pixels)
                visit(x, y, std::min(x + block_pixels, view_.width()), below);
            y = below;
        }
        std::vector<NeededPage> found;
        found.reserve(pixels_.size());
        for (const auto& [key, pixels] : pixels_) found.push_back({key, pixels});
        std::ranges::sort(found, [](const NeededPage& a, const NeededPage& b) { return b.key < a.key; });
        return found;
    }

  private:
    /// Where a corner of pixels lies, which near the horizon may be beyond it: as point_at of plane.frag.
    GroundPoint ground(double x, double y, double middle_y) const {
        const double tangent = view_.tangent_y();
        const auto fall_at = [&](double row) {
            return -(view_.forward().z + (1 - 2 * row / view_.height()) * tangent * view_.up().z);
        };
        const double fall = std::max(fall_at(y), 0.3 * fall_at(middle_y));
        const double across = (2 * x / view_.width() - 1) * view_.tangent_x();
        const double upwards = (1 - 2 * y / view_.height()) * tangent;
        const double reach = view_.camera().height_texels / fall;
        return {reach * (view_.forward().x + across * view_.right().x + upwards * view_.up().x),
                reach * (view_.forward().y + across * view_.right().y + upwards * view_.up().y)};
    }

    /// The levels that the pixel with this middle reads.
    Range levels_at(double x, double y) const {
        if (sampling_.kind == Sampling::Kind::line_integral) {
            const GroundPoint a = ground(x - 0.5, y - 0.5, y), b = ground(x + 0.5, y - 0.5, y),
                              c = ground(x + 0.5, y + 0.5, y), d = ground(x - 0.5, y + 0.5, y);
            const auto [left, right] = std::minmax({a.x, b.x, c.x, d.x});
            const auto [top, bottom] = std::minmax({a.y, b.y, c.y, d.y});
            // Grown to a texel, as in line_integral.glsl
            const double width = std::max(right - left, 0.7), height = std::max(bottom - top, 0.7);
            const double level =
                line_integral_level(std::min(width, height), std::max(width, height), sampling_.columns) +
                lod_bias_;
            return {std::ceil(level - 0.1), std::ceil(level + 0.05)};
        }
        // PlaneView::level_at tells where these come from
        const double fall =
            -(view_.forward().z + (1 - 2 * y / view_.height()) * view_.tangent_y() * view_.up().z);
        const double slope = (2 * x / view_.width() - 1) * view_.tangent_x() * view_.up().z;
        const double along_row = view_.camera().height_texels * view_.pixel_step() / fall;
        const double along_column = along_row * std::sqrt(1 + slope * slope) / fall;
        const double longer = std::max(along_row, along_column), shorter = std::min(along_row, along_column);
        // Probes are whole, so the level jumps as their count does: within a block, all that it may be
        const double finest = longer / std::min(longer / shorter + 1, most_anisotropy);
        const double coarsest = std::max(longer / most_anisotropy, shorter);
        constexpr double margin = 0.01;  // the shader's floats
        return {std::floor(std::log2(finest) + lod_bias_ - margin),
                std::floor(std::log2(coarsest) + lod_bias_ + margin) + 1};
    }

    /// How a pixel's point moves as the pixel moves down by one.
    GroundPoint column_side(double x, double y) const {
        const GroundPoint above = ground(x, y - 0.5, y), below = ground(x, y + 0.5, y);
        return {below.x - above.x, below.y - above.y};
    }

    void visit(int left, int top, int right, int bottom) {
        Range levels{1e9, -1e9};
        const auto look = [&](double x, double y) {
            const Range here = levels_at(x, y);
            levels.low = std::min(levels.low, here.low);
            levels.high = std::max(levels.high, here.high);
        };
        const double first = left + 0.5, last = right - 0.5;
        for (const double y : {top + 0.5, (top + bottom) / 2.0, bottom - 0.5}) {
            for (const double x : {first, (left + right) / 2.0, last}) look(x, y);
            // Boxes are narrowest where footprints lie along an axis
            const GroundPoint at_first = column_side(first, y), at_last = column_side(last, y);
            if (at_first.x * at_last.x < 0)
                look(first + (last - first) * at_first.x / (at_first.x - at_last.x), y);
            if (at_first.y * at_last.y < 0)
                look(first + (last - first) * at_first.y / (at_first.y - at_last.y), y);
        }
        const Quadrilateral corners{ground(left, top, top + 0.5), ground(right, top, top + 0.5),
                                    ground(right, bottom, bottom - 0.5), ground(left, bottom, bottom - 0.5)};
        const double pixels = (right - left) * (bottom - top);
        const auto clamped = [&](double level) {
            return static_cast<int>(std::clamp(level, 0.0, static_cast<double>(extent_.n)));
        };
        for (int level = clamped(levels.low); level <= clamped(levels.high); ++level)
            add_pages(corners, static_cast<std::uint8_t>(level), pixels);
    }

    /// The pages of a level that meet a quadrilateral share its pixels evenly.
    void add_pages(const Quadrilateral& corners, std::uint8_t level, double pixels) {
        const PlanePoint& eye = view_.camera().ground;
        const auto page_of = [&](double offset, std::int64_t texel, double fraction) {
            const double last = static_cast<double>(extent_.side_pages(level)) - 1;
            const auto side = static_cast<double>(std::int64_t{page_side_texels} << level);
            // Split, so that no double holds an absolute coordinate
            const std::int64_t origin = texel >> (8 + level);
            const double within = static_cast<double>(texel - (origin << (8 + level))) + fraction + offset;
            return std::clamp(std::floor(within / side) + static_cast<double>(origin), 0.0, last);
        };
        double low_x = corners[0].x, high_x = low_x, low_y = corners[0].y, high_y = low_y;
        for (const GroundPoint& corner : corners) {
            low_x = std::min(low_x, corner.x);
            high_x = std::max(high_x, corner.x);
            low_y = std::min(low_y, corner.y);
            high_y = std::max(high_y, corner.y);
        }
        const auto first_x = static_cast<std::int64_t>(page_of(low_x, eye.x, eye.fraction_x)),
                   last_x = static_cast<std::int64_t>(page_of(high_x, eye.x, eye.fraction_x)),
                   first_y = static_cast<std::int64_t>(page_of(low_y, eye.y, eye.fraction_y)),
                   last_y = static_cast<std::int64_t>(page_of(high_y, eye.y, eye.fraction_y));
        // More than a window holds: what lies beyond it is shown by coarser pages
        constexpr std::int64_t most = 256;
        if (last_x - first_x > most || last_y - first_y > most) return;
        std::vector<PageKey> met;
        const std::int64_t side = std::int64_t{page_side_texels} << level;
        for (std::int64_t y = first_y; y <= last_y; ++y) {
            for (std::int64_t x = first_x; x <= last_x; ++x) {
                const double left = static_cast<double>(x * side - eye.x) - eye.fraction_x;
                const double top = static_cast<double>(y * side - eye.y) - eye.fraction_y;
                if (is_apart(corners, left, top, static_cast<double>(side))) continue;
                met.push_back({level, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)});
            }
        }
        for (const PageKey key : met) pixels_[key] += pixels / static_cast<double>(met.size());
    }

    /// Whether a side of the quadrilateral separates it from the square; the square's own sides are known not
    /// to.
    static bool is_apart(const Quadrilateral& corners, double left, double top, double side) {
        for (std::size_t i = 0; i < 4; ++i) {
            const GroundPoint a = corners[i], b = corners[(i + 1) % 4], opposite = corners[(i + 2) % 4];
            const double nx = b.y - a.y, ny = a.x - b.x;
            const double inside = nx * (opposite.x - a.x) + ny * (opposite.y - a.y);
            const double sign = inside < 0 ? -1 : 1;
            double most = -1e300;
            for (int corner = 0; corner < 4; ++corner)
                most = std::max(most, sign * (nx * (left + (corner % 2) * side - a.x) +
                                              ny * (top + (corner / 2) * side - a.y)));
            if (most < 0) return true;
        }
        return false;
    }

    const PlaneView& view_;
    Extent extent_;
    double lod_bias_;
    Sampling sampling_;
    std::unordered_map<PageKey, double> pixels_;
};

}  // namespace

std::vector<NeededPage> needed_by_footprints(const PlaneView& view, Extent extent, double lod_bias,
                                             const Sampling& sampling) {
    return Blocks{view, extent, lod_bias, sampling}.run();
}

}  // namespace tessera
