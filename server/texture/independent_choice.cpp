#include "server/texture/independent_choice.h"

#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"

namespace tessera {

IndependentChoice::IndependentChoice(std::uint64_t seed, const PatchMap& map, const ExemplarTexels& texels,
                                     const Stamps& stamps) {
    const int tile_level = static_cast<int>(map.levels().size()) - 1;
    for (std::size_t p = 0; p < texels.patch_count(); ++p) {
        keys_.push_back(seed ^ stream("independent contents", p));
        first_content_.push_back(static_cast<std::uint32_t>(sums_.size()));
        for (std::size_t content = 0; content < texels.content_count(p); ++content) {
            NodeSums sums;
            for (std::int32_t y = 0; y < 2; ++y)
                for (const PatchMap::Span& span : map.levels()[std::size_t(tile_level)].row(y)) {
                    if (span.patch != p) continue;
                    const float* stamp = stamps.stamp(tile_level, p, content) + std::size_t{span.offset} * 3;
                    for (std::int32_t x = span.begin; x < span.end; ++x)
                        for (std::int32_t c = 0; c < 3; ++c)
                            sums.part[y * 2 + x][c] = double{stamp[(x - span.begin) * 3 + c]};
                }
            sums_.push_back(sums);
        }

        // Parts of a patch may fall into different texels, so their ranges are added, never netted
        double patch_distance = 0, patch_range = 0;
        for (std::size_t part = 0; part < 4; ++part) {
            double part_distance = 0, part_range = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                double least = INFINITY, greatest = -INFINITY, total = 0;
                for (std::size_t i = first_content_[p]; i < sums_.size(); ++i) {
                    least = std::min(least, sums_[i].part[part][c]);
                    greatest = std::max(greatest, sums_[i].part[part][c]);
                    total += sums_[i].part[part][c];
                }
                const double mean = total / static_cast<double>(sums_.size() - first_content_[p]);
                expectation_[c] += mean;
                part_distance = std::max({part_distance, greatest - mean, mean - least});
                part_range = std::max(part_range, greatest - least);
            }
            patch_distance += part_distance;
            patch_range += part_range;
        }
        range_ += patch_distance;
        squared_ranges_ += patch_range * patch_range;
    }
    first_content_.push_back(static_cast<std::uint32_t>(sums_.size()));
}

void IndependentChoice::contents_of(std::int64_t tile_x, std::int64_t tile_y,
                                    std::uint8_t* contents) const noexcept {
    for (std::size_t p = 0; p < keys_.size(); ++p)
        contents[p] = static_cast<std::uint8_t>(
            uniform_below(hash(0, keys_[p], tile_x, tile_y), first_content_[p + 1] - first_content_[p]));
}

void IndependentChoice::add_enumerated(int height, std::int64_t x, std::int64_t y, std::int32_t width,
                                       double* rgb) const {
    const std::int64_t side = std::int64_t{1} << height;
    const double share = 1.0 / (static_cast<double>(side) * static_cast<double>(side));
    // Tiles under the row, and the row and column of tiles before it, whose patches hang over into it
    for (std::int64_t tile_y = y * side - 1; tile_y < (y + 1) * side; ++tile_y)
        for (std::int64_t tile_x = x * side - 1; tile_x < (x + width) * side; ++tile_x) {
            NodeSums tile;
            for (std::size_t p = 0; p < keys_.size(); ++p) {
                const std::uint32_t content = uniform_below(hash(0, keys_[p], tile_x, tile_y),
                                                            first_content_[p + 1] - first_content_[p]);
                const NodeSums& sums = sums_[first_content_[p] + content];
                for (std::size_t part = 0; part < 4; ++part)
                    for (std::size_t c = 0; c < 3; ++c) tile.part[part][c] += sums.part[part][c];
            }
            for (std::int64_t part = 0; part < 4; ++part) {
                const std::int64_t column = ((tile_x + part % 2) >> height) - x;
                const std::int64_t row = ((tile_y + part / 2) >> height) - y;
                if (row != 0 || column < 0 || column >= width) continue;
                for (std::size_t c = 0; c < 3; ++c)
                    rgb[std::size_t(column) * 3 + c] += share * tile.part[std::size_t(part)][c];
            }
        }
}

IndependentChoice::Bound IndependentChoice::bound(int height) const noexcept {
    // A texel meets at most (2^height + 1)² tiles, each with a share of 4^−height
    const double side = std::ldexp(1.0, height);
    const double tiles = (side + 1) * (side + 1), share = 1 / (side * side);
    Bound bound;
    bound.certain = range_ * tiles * share;
    // P(|sum − mean| ≥ t) ≤ 2·exp(−2t² / Σ ranges²), for each of three channels
    const double variance = squared_ranges_ * tiles * share * share;
    bound.likely = std::min(bound.certain, std::sqrt(variance * std::log(6 / (1 - confidence)) / 2));
    return bound;
}

}  // namespace tessera
