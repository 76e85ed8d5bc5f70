#include "server/scenes/patterns/trees.h"

#include <cmath>

#include "server/scenes/patterns/shapes.h"
#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera::painting {
namespace {

/// Samples along the side of a texel; a slice is as thick as `slice_texels`.
constexpr std::int32_t grain = 2;
constexpr double slice_texels = 1.6;

struct Tuft {
    double x, y, z, radius;
};

/// Tufts of leaves on the outside of a crown; lengths in parts of the square's side.
std::vector<Tuft> tufts_of(std::int32_t number, Dice& dice) {
    std::vector<Tuft> tufts;
    if (number == 0) {
        for (int i = 0; i < 46; ++i) {
            const Direction d = any_direction(dice);
            const double up = dice.uniform(-0.75, 1.0),
                         out = std::sqrt(1 - up * up) * dice.uniform(0.75, 1.0);
            tufts.push_back(
                {d.x * out * 0.34, d.y * out * 0.34, 0.49 + 0.24 * up, dice.uniform(0.085, 0.125)});
        }
    } else {
        const Direction start = any_direction(dice);
        for (int whorl = 0; whorl < 9; ++whorl) {
            const double z = 0.13 + 0.072 * whorl, reach = 0.40 * (1 - whorl / 9.6);
            const int branches = 10 - whorl / 2;
            for (int i = 0; i < branches; ++i) {
                const Direction d = turned(start, (i + 0.37 * whorl + dice.uniform(-0.12, 0.12)) / branches);
                for (double far = 0.25; far <= 1.0; far += 0.25)
                    tufts.push_back({d.x * reach * far, d.y * reach * far, z - 0.05 * far * far + 0.02,
                                     0.052 * (1.25 - 0.4 * far)});
            }
        }
    }
    return tufts;
}

}  // namespace

std::vector<Rgba8Image> paint_tree(std::int32_t number, std::int32_t side) {
    Dice dice{hash(7, stream("tree"), number, 0)};
    const std::vector<Tuft> tufts = tufts_of(number, dice);
    const auto salt = static_cast<std::uint32_t>(dice.bits());
    const std::int32_t n = side * grain, layers = tree_slices;
    const auto area = std::size_t(n) * std::size_t(n);
    std::vector<float> leaves(area * std::size_t(layers));
    const double height = slice_texels / side;  // of a slice, in parts of the side

    for (const Tuft& tuft : tufts) {
        const auto bound = [](double v, std::int32_t most) {
            return static_cast<std::int32_t>(std::clamp<std::int64_t>(whole_below(v), 0, most));
        };
        const std::int32_t low = bound((tuft.z - tuft.radius) / height, layers),
                           high = bound((tuft.z + tuft.radius) / height + 1, layers);
        const std::int32_t left = bound((tuft.x - tuft.radius + 0.5) * n, n),
                           right = bound((tuft.x + tuft.radius + 0.5) * n + 1, n);
        const std::int32_t top = bound((tuft.y - tuft.radius + 0.5) * n, n),
                           bottom = bound((tuft.y + tuft.radius + 0.5) * n + 1, n);
        for (std::int32_t k = low; k < high; ++k)
            for (std::int32_t j = top; j < bottom; ++j)
                for (std::int32_t i = left; i < right; ++i) {
                    const double x = (i + 0.5) / n - 0.5 - tuft.x, y = (j + 0.5) / n - 0.5 - tuft.y,
                                 z = (k + 0.5) * height - tuft.z;
                    const double far = (x * x + y * y + z * z) / (tuft.radius * tuft.radius);
                    if (far >= 1) continue;
                    float& leaf =
                        leaves[std::size_t(k) * area + std::size_t(j) * std::size_t(n) + std::size_t(i)];
                    leaf = std::max(leaf, static_cast<float>(1 - far));
                }
    }
    // Light that reaches a place from above
    std::vector<float> dark(area);
    std::vector<Rgba8Image> slices(static_cast<std::size_t>(layers));
    for (std::int32_t k = layers - 1; k >= 0; --k) {
        Rgba8Image slice{side, side};
        const double z = (k + 0.5) * height,
                     trunk = number == 0 ? 0.034 - 0.018 * z / 0.6 : 0.027 - 0.026 * z / 0.8;
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                LinearColor sum{};
                double covered = 0, shade = 0;
                for (std::int32_t j = y * grain; j < (y + 1) * grain; ++j)
                    for (std::int32_t i = x * grain; i < (x + 1) * grain; ++i) {
                        const std::size_t at = std::size_t(j) * std::size_t(n) + std::size_t(i);
                        const double u = (i + 0.5) / n - 0.5, v = (j + 0.5) / n - 0.5;
                        const double fine =
                            noise(i * 0.55 + k * 7.3, j * 0.55, salt + static_cast<std::uint32_t>(k));
                        const double clump = noise(u * 22 + 0.35 * k, v * 22 - 0.3 * k, salt + 90);
                        const double leaf = double{leaves[std::size_t(k) * area + at]};
                        const double density = leaf > 0 ? leaf + 0.34 * fine + 0.18 * clump - 0.34 : -1;
                        const double above = double{dark[at]};
                        const double light = 1 / (1 + 0.42 * above);
                        double alpha = 0;
                        LinearColor color{};
                        const double r = std::sqrt(u * u + v * v);
                        const double rim = trunk * (1 + 0.2 * noise(u * 60, v * 60 + z * 9, salt + 5)) *
                                           (z < 0.05 ? 1 + (0.05 - z) * 14 : 1);
                        if (r < rim) {
                            alpha = 1;
                            color =
                                tinted({0.20, 0.135, 0.085},
                                       (0.40 + 0.6 * light) * (0.8 + 0.4 * noise(u * 90, v * 90, salt + 6)));
                        } else if (density > 0) {
                            alpha = smooth_step(0.0, 0.12, density);
                            const double tone = std::clamp(0.5 + 0.4 * fine + 0.3 * clump, 0.0, 1.0);
                            color = number == 0 ? blend({0.040, 0.095, 0.016}, {0.215, 0.315, 0.055}, tone)
                                                : blend({0.018, 0.058, 0.026}, {0.115, 0.205, 0.075}, tone);
                            // Lit from the upper left, as all else here
                            color = tinted(color, light * (0.92 - 0.9 * (u + v)) * (0.55 + 0.75 * z / 0.7));
                        }
                        dark[at] = static_cast<float>(above + 0.55 * alpha);
                        for (std::size_t c = 0; c < 3; ++c) sum[c] += std::max(0.0, color[c]) * alpha;
                        covered += alpha;
                        shade += above;
                    }
                double alpha = covered / (grain * grain);
                std::uint8_t* texel = slice.row(y) + std::ptrdiff_t{4} * x;
                const double under = k == 0 ? 0.62 * smooth_step(0.0, 5.0, shade / (grain * grain)) : 0.0;
                const double whole = alpha + (1 - alpha) * under;
                texel[3] = static_cast<std::uint8_t>(whole * 255 + 0.5);
                if (texel[3] == 0) continue;
                for (std::size_t c = 0; c < 3; ++c)
                    texel[c] =
                        steps_to_srgb()[to_steps(static_cast<float>(sum[c] / (grain * grain) / whole))];
            }
        slices[static_cast<std::size_t>(k)] = std::move(slice);
    }
    return slices;
}

}  // namespace tessera::painting
