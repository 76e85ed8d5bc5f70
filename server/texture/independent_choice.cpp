#include "server/texture/independent_choice.h"

#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"

namespace tessera {

IndependentChoice::IndependentChoice(std::uint64_t seed, const Shapes& shapes) {
    for (std::size_t p = 0; p < shapes.patch_count(); ++p) {
        keys_.push_back(seed ^ stream("independent contents", p));
        first_of_.push_back(shapes.first_of(p));
    }
    first_of_.push_back(shapes.first_of(shapes.patch_count()));
}

std::uint32_t IndependentChoice::content_of(std::size_t patch, std::int64_t tile_x,
                                            std::int64_t tile_y) const noexcept {
    return uniform_below(hash(0, keys_[patch], tile_x, tile_y), first_of_[patch + 1] - first_of_[patch] + 1);
}

std::vector<Shown> IndependentChoice::shown_by(std::int64_t tile_x, std::int64_t tile_y) const {
    std::vector<Shown> shown;
    for (std::size_t p = 0; p < keys_.size(); ++p)
        if (const std::uint32_t content = content_of(p, tile_x, tile_y); content > 0)
            shown.push_back({static_cast<std::uint16_t>(first_of_[p] + content - 1), 0, 0});
    return shown;
}

IndependentSums::IndependentSums(const Shapes& shapes, const StampSpans::Level& one_texel_tiles,
                                 const float* values) {
    for (std::size_t p = 0; p < shapes.patch_count(); ++p) {
        first_content_.push_back(static_cast<std::uint32_t>(sums_.size()));
        sums_.emplace_back();
        for (std::uint32_t shape = shapes.first_of(p); shape < shapes.first_of(p + 1); ++shape) {
            Sums sums;
            std::int32_t y = one_texel_tiles.stamps[shape].y;
            for (const StampSpans::Span& span : one_texel_tiles.of(shape)) {
                const float* from = values + std::size_t{span.offset} * StampSpans::row_floats;
                for (std::int32_t x = span.begin; x < span.end; ++x)
                    for (std::int32_t c = 0; c < 3; ++c) sums.part[y * 2 + x][c] = double{*from++};
                ++y;
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

void IndependentSums::add_enumerated(const IndependentChoice& choice, int height, std::int64_t x,
                                     std::int64_t y, std::int32_t width, double* rgb) const {
    const std::int64_t side = std::int64_t{1} << height;
    const double share = 1.0 / (static_cast<double>(side) * static_cast<double>(side));
    // Tiles under the row, and the row and column of tiles before it, whose patches hang over into it
    for (std::int64_t tile_y = y * side - 1; tile_y < (y + 1) * side; ++tile_y)
        for (std::int64_t tile_x = x * side - 1; tile_x < (x + width) * side; ++tile_x) {
            Sums tile;
            for (std::size_t p = 0; p < choice.patch_count(); ++p) {
                const Sums& sums = sums_[first_content_[p] + choice.content_of(p, tile_x, tile_y)];
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

IndependentSums::Bound IndependentSums::bound(int height) const noexcept {
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
