#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "server/filter/convex_polygon.h"
#include "server/filter/footprint_sampler.h"

namespace tessera {

/// An image of random steps; alpha is 1 where `opaque`.
inline LinearImage noise_image(std::int32_t width, std::int32_t height, unsigned seed, bool opaque = false) {
    std::mt19937 random{seed};
    LinearImage image{width, height};
    for (std::size_t i = 0; i < image.values.size(); ++i)
        image.values[i] = opaque && i % 4 == 3 ? 1.0F : static_cast<float>(random() % 65536) / 65535.0F;
    return image;
}

inline LinearImage constant_image(std::int32_t width, std::int32_t height, std::array<float, 4> color) {
    LinearImage image{width, height};
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = color[i % 4];
    return image;
}

/// The truth, texel by texel of level 0: only for footprints of some thousand texels.
inline std::array<double, 4> area_average(const TexelPages& pages, const Footprint& footprint) {
    double left = 1e300, top = 1e300, right = -1e300, bottom = -1e300;
    ConvexPolygon quadrilateral;
    for (const TexelPoint& p : footprint.corners) {
        quadrilateral.corners[quadrilateral.count++] = p;
        left = std::min(left, p.x);
        right = std::max(right, p.x);
        top = std::min(top, p.y);
        bottom = std::max(bottom, p.y);
    }
    std::array<double, 4> sum{};
    double total = 0;
    std::shared_ptr<const TexelPage> page;
    std::int64_t held_x = 0, held_y = 0;
    ConvexPolygon a, b, row;
    for (double y = std::floor(top); y < bottom; ++y) {
        cut<false, true>(quadrilateral, y, a);
        cut<false, false>(a, y + 1, row);
        for (double x = std::floor(left); x < right && row.count > 2; ++x) {
            cut<true, true>(row, x, a);
            cut<true, false>(a, x + 1, b);
            double area = 0;
            for (int k = 0; k < b.count; ++k) {
                const TexelPoint p{b.corners[k].x - x, b.corners[k].y - y};
                const TexelPoint q{b.corners[(k + 1) % b.count].x - x, b.corners[(k + 1) % b.count].y - y};
                area += p.x * q.y - p.y * q.x;
            }
            area = std::fabs(area) / 2;
            if (area == 0) continue;
            const std::int64_t i = footprint.x + static_cast<std::int64_t>(x),
                               j = footprint.y + static_cast<std::int64_t>(y);
            if (!page || held_x != i >> 8 || held_y != j >> 8)
                page = pages.page(0, held_x = i >> 8, held_y = j >> 8, footprint.slice, {}).value();
            for (std::size_t c = 0; c < 4; ++c)
                sum[c] += area * page->steps[static_cast<std::size_t>(((j & 255) << 8 | (i & 255)) * 4) + c];
            total += area;
        }
    }
    for (double& s : sum) s /= total * 65535;
    return sum;
}

/// In codes of linear light.
inline double furthest(const FilteredSample& sample, const std::array<double, 4>& truth) {
    double most = 0;
    for (std::size_t c = 0; c < 4; ++c)
        most = std::max(most, std::fabs(static_cast<double>(sample.color[c]) - truth[c]) * 255);
    return most;
}

inline FilteredSample sample_one(FootprintSampler& sampler, const Footprint& footprint) {
    FilteredSample sample;
    sampler.sample({&footprint, 1}, {}, {&sample, 1}).value();
    return sample;
}

/// Parallelograms, trapezoids and general quadrilaterals around (x, y), their size and shape over orders of
/// magnitude.
class RandomFootprints {
  public:
    explicit RandomFootprints(unsigned seed) : random_{seed} {}

    Footprint next(std::int64_t x, std::int64_t y, double most_side) {
        for (;;) {
            const double side = most_side * std::pow(2.0, -10 * uniform()),
                         ratio = std::pow(2.0, -8 * uniform());
            const double turn = uniform() * 6.283185307179586;
            const TexelPoint along{std::cos(turn) * side, std::sin(turn) * side};
            const double across = side * ratio, lean = uniform() - 0.5;
            Footprint f = footprint_around(x, y, {uniform() * 8 - 4, uniform() * 8 - 4}, along,
                                           {-std::sin(turn) * across + lean * along.x * ratio,
                                            std::cos(turn) * across + lean * along.y * ratio});
            if (uniform() < 0.5)
                for (TexelPoint& p : f.corners) {
                    p.x += (uniform() - 0.5) * across / 2;
                    p.y += (uniform() - 0.5) * across / 2;
                }
            if (uniform() < 0.5) std::swap(f.corners[1], f.corners[3]);
            if (check_footprint(f) && area_of(f) > 0) return f;
        }
    }

    double uniform() { return static_cast<double>(random_() % (1u << 30)) / (1u << 30); }

  private:
    std::mt19937 random_;
};

}  // namespace tessera
