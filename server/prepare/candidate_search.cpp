#include "server/prepare/candidate_search.h"

#include <algorithm>
#include <atomic>
#include <map>

#include "server/prepare/border_band.h"
#include "server/prepare/candidates.h"
#include "server/prepare/parallel.h"

namespace tessera {
namespace {

using Offset = ExchangeAsset::Offset;
using Box = ExchangeAsset::Patch;

/// The photograph at full resolution, halved, and so on.
using Pyramid = std::map<std::int32_t, PerceptualImage>;

/// Places where the tile itself shows the patch: as many as there are cuts through it, and one.
std::vector<Offset> own_places(const PeriodicTile& tile, const Segmentation& segmentation,
                               std::size_t patch) {
    const auto& box = segmentation.patches[patch];
    const std::int32_t wrap = tile.side - 1;
    std::vector<Offset> places;
    for (std::int32_t y = 0; y < box.height; ++y)
        for (std::int32_t x = 0; x < box.width; ++x) {
            const auto i = static_cast<std::size_t>(((box.y + y) & wrap) * tile.side + ((box.x + x) & wrap));
            if (segmentation.labels[i] != patch) continue;
            const Offset place{tile.sources[i].x - x, tile.sources[i].y - y};
            const auto same = [&](const Offset& other) { return other.x == place.x && other.y == place.y; };
            if (std::none_of(places.begin(), places.end(), same)) places.push_back(place);
        }
    return places;
}

/// Every place of the photograph on the coarse grid, the cheapest first.
std::vector<Candidate> search_coarsely(const BorderBand& band, const PerceptualImage& photo, const Box& box,
                                       const Liveliness& liveliness) {
    const std::vector<std::uint32_t> costs = all_differences(band, photo);
    const std::int32_t columns = photo.width - band.width + 1;
    std::vector<Candidate> found;
    found.reserve(costs.size());
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const auto place = static_cast<std::int32_t>(i);
        const Offset at{band.margin + place % columns * band.factor,
                        band.margin + place / columns * band.factor};
        found.push_back({liveliness.weigh(costs[i], at, box.width, box.height), at});
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// The best of the candidate's place and its eight neighbours, a step of the band's factor away.
void refine(Candidate& candidate, const BorderBand& band, const PerceptualImage& photo, Span across,
            Span down) {
    const Offset centre = candidate.at;
    bool found = false;
    for (std::int32_t v = -1; v <= 1; ++v)
        for (std::int32_t u = -1; u <= 1; ++u) {
            const Offset at{centre.x + u * band.factor, centre.y + v * band.factor};
            if (at.x < across.first || at.x > across.last || at.y < down.first || at.y > down.last) continue;
            const Candidate moved{mean_difference(band, photo, at.x, at.y), at};
            if (!found || moved < candidate) candidate = moved;
            found = true;
        }
}

/// What every patch's search reads.
struct Sources {
    Pyramid pyramid;
    Liveliness liveliness;
    const PerceptualImage& tile_colors;
    const PeriodicTile& tile;
    const Segmentation& segmentation;
};

std::vector<Candidate> search_patch(const Sources& sources, std::size_t patch, const CandidateSearch& search,
                                    std::int32_t coarsest) {
    const Box& box = sources.segmentation.patches[patch];
    const PerceptualImage& photo = sources.pyramid.at(1);
    const auto band_at = [&](std::int32_t factor) {
        // Three texels beyond the blending: what the eye compares across the border
        return make_border_band(sources.tile_colors, sources.segmentation, patch, search.blend_texels / 2 + 3,
                                factor);
    };
    const std::size_t wanted = search.wanted;
    const std::vector<Offset> own = own_places(sources.tile, sources.segmentation, patch);

    // Exhaustively on a coarse grid; a finer one where the photograph leaves few places
    std::int32_t factor = coarsest;
    BorderBand band = band_at(factor);
    std::vector<Candidate> everywhere =
        search_coarsely(band, sources.pyramid.at(factor), box, sources.liveliness);
    while (everywhere.size() < 4 * wanted && factor > 1) {
        factor /= 2;
        band = band_at(factor);
        everywhere = search_coarsely(band, sources.pyramid.at(factor), box, sources.liveliness);
    }

    // Far more than wanted, to choose from; closer together only if there is no choice
    std::int32_t distance = distinct_distance(box);
    std::vector<Candidate> candidates;
    for (;; distance /= 2) {
        candidates = spread(everywhere, own, distance + factor - 1, wanted);
        if (candidates.size() >= wanted || distance <= 1) break;
    }
    everywhere = {};
    while (factor > 1) {
        factor /= 2;
        band = band_at(factor);
        const PerceptualImage& level = sources.pyramid.at(factor);
        const Span across = span_of(photo.width, band.width, band);
        const Span down = span_of(photo.height, band.height, band);
        for (Candidate& candidate : candidates) refine(candidate, band, level, across, down);
    }
    for (Candidate& candidate : candidates)
        candidate.cost =
            sources.liveliness.weigh(mean_difference(band, photo, candidate.at.x, candidate.at.y),
                                     candidate.at, box.width, box.height);
    std::sort(candidates.begin(), candidates.end());
    return spread(candidates, own, distance, candidates.size());
}

/// How far the photograph is reduced for the exhaustive search: a band keeps some texels of width, and the
/// work stays within some seconds.
std::int32_t coarsest_factor(const PerceptualImage& photo, const Segmentation& segmentation,
                             std::int32_t side, std::int32_t blend_texels) {
    const auto patches = std::ssize(segmentation.patches);
    std::int64_t cell = side;
    while (cell * cell * patches > std::int64_t{side} * side) --cell;
    const std::int64_t width = blend_texels + 6;
    std::int64_t factor = cell >= 24 ? 4 : cell >= 12 ? 2 : 1;
    const auto work = [&] {
        const std::int64_t places = std::int64_t{photo.width} * photo.height / (factor * factor);
        return patches * places * (4 * cell * width / (factor * factor) + 1);
    };
    while (work() > 6'000'000'000 && factor < 16) factor *= 2;
    return static_cast<std::int32_t>(factor);
}

}  // namespace

std::int32_t distinct_distance(const Box& box) { return std::max(4, std::min(box.width, box.height) / 8); }

std::vector<std::vector<Candidate>> find_candidates(const PerceptualImage& photo,
                                                    const PerceptualImage& tile_colors,
                                                    const PeriodicTile& tile,
                                                    const Segmentation& segmentation,
                                                    const CandidateSearch& search, Progress& progress) {
    const std::int32_t coarsest = coarsest_factor(photo, segmentation, tile.side, search.blend_texels);
    Sources sources{{}, Liveliness{photo}, tile_colors, tile, segmentation};
    for (std::int32_t factor = 1; factor <= coarsest; factor *= 2)
        sources.pyramid[factor] = reduced(photo, factor);
    std::vector<std::vector<Candidate>> candidates(segmentation.patches.size());
    std::atomic<std::size_t> done{0};
    for_each_index(candidates.size(), search.threads, [&](std::size_t patch) {
        if (progress.stop().stop_requested()) return;
        candidates[patch] = search_patch(sources, patch, search, coarsest);
        search.advance(static_cast<double>(++done) / static_cast<double>(candidates.size()));
    });
    return candidates;
}

}  // namespace tessera
