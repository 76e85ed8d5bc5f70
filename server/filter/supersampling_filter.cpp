#include "server/filter/supersampling_filter.h"

#include <bit>
#include <cmath>

#include "shared/math/hash.h"

namespace tessera {

namespace {

constexpr double most_side = 4096;
/// Samples of a block that differ by more, in steps, are too few: two codes.
constexpr std::int32_t alike_steps = 2 * 257;

/// Hoeffding, "Probability inequalities for sums of bounded random variables", JASA 58, 1963: a sum of
/// independent terms within ranges r_i is further than √(½·ln(2/δ)·Σr_i²) from its expectation with a
/// probability of at most δ. Here δ is 10^−9 shared among four channels and all choices of blocks to refine,
/// each of which makes another sum of independent terms: ln(2·4·2^blocks/10^−9).
double root_of_hoeffding(int blocks) noexcept {
    return std::sqrt((22.8026 + 0.693148 * blocks * blocks) / 2);
}

double cross(TexelPoint a, TexelPoint b) noexcept { return a.x * b.y - a.y * b.x; }

Ints4 least_of(Ints4 a, Ints4 b) noexcept { return a < b ? a : b; }
Ints4 most_of(Ints4 a, Ints4 b) noexcept { return a > b ? a : b; }

}  // namespace

SupersamplingFilter::Map SupersamplingFilter::map_of(const Footprint& footprint) {
    const auto& c = footprint.corners;
    const FootprintBox box = box_of(footprint);
    Map map;
    map.level = level_of_at_most(std::max(box.width(), box.height()), most_side);
    const LocalFrame frame{footprint, box, map.level, map.level};
    map.x = frame.x;
    map.y = frame.y;
    map.at = frame(c[0]);
    const double scale = frame.scale;
    map.along = {(c[1].x - c[0].x) * scale, (c[1].y - c[0].y) * scale};
    map.across = {(c[3].x - c[0].x) * scale, (c[3].y - c[0].y) * scale};
    map.twist = {(c[2].x - c[3].x) * scale - map.along.x, (c[2].y - c[3].y) * scale - map.along.y};

    // The map's area at (s, t): cross(along + t·twist, across + s·twist), linear in both
    const double own = cross(map.along, map.across), by_s = cross(map.along, map.twist),
                 by_t = cross(map.twist, map.across), mean = own + by_s / 2 + by_t / 2;
    if (mean != 0) {
        const double least =
            std::min(std::min(0.0, by_s / mean) + std::min(0.0, by_t / mean) + own / mean, 1.0);
        if (least >= -1e-6) {
            map.unbiased = true;
            map.weight = own / mean;
            map.weight_along = by_s / mean;
            map.weight_across = by_t / mean;
            map.greatest_weight =
                map.weight + std::max(0.0, map.weight_along) + std::max(0.0, map.weight_across);
        }
    }

    std::uint64_t key =
        hash(stream("supersampling"), static_cast<std::uint64_t>(footprint.slice), footprint.x, footprint.y);
    for (const TexelPoint& p : c)
        key = hash(key, 0, std::bit_cast<std::int64_t>(p.x), std::bit_cast<std::int64_t>(p.y));
    map.key = key;
    return map;
}

const std::uint16_t* SupersamplingFilter::texel(const Map& map, double s, double t, Reading& reading) {
    const std::int64_t x = map.x +
                           floor_of(map.at.x + s * (map.along.x + t * map.twist.x) + t * map.across.x),
                       y = map.y +
                           floor_of(map.at.y + s * (map.along.y + t * map.twist.y) + t * map.across.y);
    return texels_.at(map.level, x >> 8, y >> 8, reading).texel(x & 255, y & 255);
}

Doubles4 SupersamplingFilter::sample(const Map& map, const Block& block, Ints4 reference, bool& alike,
                                     Reading& reading) {
    Ints4 least{65535, 65535, 65535, 65535}, most{};
    Doubles4 sum;
    const double step = 1.0 / block.side;
    for (int j = block.from_y; j < block.to_y; ++j)
        for (int i = block.from_x; i < block.to_x; ++i) {
            double in_s = 0.5, in_t = 0.5;
            if (jittered_) {
                const std::uint64_t bits =
                    mix(map.key +
                        0x9e3779b97f4a7c15u * static_cast<std::uint64_t>((block.side << 20) + (j << 10) + i));
                in_s = static_cast<double>(bits >> 32) * 0x1p-32;
                in_t = static_cast<double>(bits & 0xffffffff) * 0x1p-32;
            }
            const double s = (i + in_s) * step, t = (j + in_t) * step;
            const Ints4 steps = load_steps(texel(map, s, t, reading));
            const double weight = map.weight + map.weight_along * s + map.weight_across * t;
            sum += Doubles4{steps - reference} * weight;
            least = least_of(least, steps);
            most = most_of(most, steps);
        }
    reading.texels += static_cast<std::uint64_t>(block.count());
    const Ints4 range = most - least;
    alike = std::max({range[0], range[1], range[2], range[3]}) <= alike_steps;
    return sum * (1.0 / block.count());
}

std::optional<StepRange> SupersamplingFilter::range_of(const Footprint& footprint, const Map& map,
                                                       Reading& reading) {
    const FootprintBox box = box_of(footprint);
    const std::int64_t x0 = (footprint.x + floor_of(box.left)) >> map.level,
                       x1 = (footprint.x + floor_of(box.right)) >> map.level,
                       y0 = (footprint.y + floor_of(box.top)) >> map.level,
                       y1 = (footprint.y + floor_of(box.bottom)) >> map.level;
    int size = TexelRanges::finest;
    while (size < TexelRanges::coarsest && std::max(x1 - x0, y1 - y0) >> size > 1) ++size;
    if (std::max(x1 - x0, y1 - y0) >> size > 1) return std::nullopt;
    StepRange range;
    for (std::int64_t j = y0 >> size; j <= y1 >> size; ++j)
        for (std::int64_t i = x0 >> size; i <= x1 >> size; ++i) {
            const int shift = TexelRanges::coarsest - size;
            const std::int64_t mask = (std::int64_t{1} << shift) - 1;
            range.widen(
                ranges_.at(map.level, i >> shift, j >> shift, reading).block(size, i & mask, j & mask));
        }
    return range;
}

Estimate SupersamplingFilter::operator()(const Footprint& footprint, Reading& reading) {
    const Map map = map_of(footprint);
    const Ints4 reference = load_steps(texel(map, 0.5, 0.5, reading));
    ++reading.texels;

    Doubles4 sum;
    double squares = 0;  // Σ of (a block's share)² / its samples
    for (int j = 0; j < blocks_; ++j)
        for (int i = 0; i < blocks_; ++i) {
            Block block{side_ * i / blocks_, side_ * (i + 1) / blocks_, side_ * j / blocks_,
                        side_ * (j + 1) / blocks_, side_};
            const double area = static_cast<double>(block.count()) / (static_cast<double>(side_) * side_);
            bool alike = false;
            Doubles4 mean = sample(map, block, reference, alike, reading);
            if (!alike && side_ > 1) {
                block = {2 * block.from_x, 2 * block.to_x, 2 * block.from_y, 2 * block.to_y, 2 * side_};
                mean = sample(map, block, reference, alike, reading);
            }
            sum += mean * area;
            squares += area * area / block.count();
        }
    Estimate estimate{sum + Doubles4{reference}};

    if (map.level > 0) {
        estimate.bound_codes = bound_of_any(estimate.steps);
        return estimate;
    }
    // The truth lies within the range of the footprint's texels; with random points, near their mean
    const auto range = range_of(footprint, map, reading);
    double certain = 0, widest = 0;
    for (int c = 0; c < 4; ++c) {
        const double least = range ? range->least[static_cast<std::size_t>(c)] : 0,
                     most = range ? range->most[static_cast<std::size_t>(c)] : 65535;
        certain = std::max({certain, most - estimate.steps[c], estimate.steps[c] - least});
        widest = std::max(widest, most - least);
    }
    constexpr double codes = 255.0 / 65535.0;
    estimate.bound_codes = certain * codes + 1e-6;
    if (!jittered_ || !map.unbiased) return estimate;
    const double likely =
        root_of_hoeffding(blocks_) * std::sqrt(squares) * widest * map.greatest_weight * codes + 1e-6;
    if (likely < estimate.bound_codes) {
        estimate.bound_codes = likely;
        estimate.confidence = 1 - 1e-9;
    }
    return estimate;
}

std::unique_ptr<FootprintSampler> make_supersampling(const FootprintFilter& filter,
                                                     std::shared_ptr<const TexelPages> pages,
                                                     std::size_t memory_bytes) {
    return std::make_unique<EachFootprint<SupersamplingFilter>>(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
