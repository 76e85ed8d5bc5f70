#include "server/prepare/contents.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <map>
#include <tuple>

#include "server/prepare/border_band.h"
#include "server/prepare/parallel.h"

namespace tessera {
namespace {

using Offset = ContentExchangeAsset::Offset;

struct Candidate {
    std::uint64_t cost = 0;
    Offset at;
    auto key() const { return std::tuple{cost, at.y, at.x}; }
    bool operator<(const Candidate& other) const { return key() < other.key(); }
};

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

bool apart(const Offset& a, const Offset& b, std::int32_t distance) {
    return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)) >= distance;
}

/// The cheapest candidates that lie `distance` apart from each other and from `taken`; at most `count`.
std::vector<Candidate> spread(const std::vector<Candidate>& sorted, const std::vector<Offset>& taken,
                              std::int32_t distance, std::size_t count) {
    std::vector<Candidate> chosen;
    for (const Candidate& candidate : sorted) {
        if (chosen.size() == count) break;
        const bool free = std::all_of(taken.begin(), taken.end(),
                                      [&](const Offset& t) { return apart(candidate.at, t, distance); }) &&
                          std::all_of(chosen.begin(), chosen.end(), [&](const Candidate& c) {
                              return apart(candidate.at, c.at, distance);
                          });
        if (free) chosen.push_back(candidate);
    }
    return chosen;
}

/// Every place of the photograph on the coarse grid, the cheapest first.
std::vector<Candidate> search_coarsely(const BorderBand& band, const PerceptualImage& photo) {
    const std::vector<std::uint32_t> costs = all_differences(band, photo);
    const std::int32_t columns = photo.width - band.width + 1;
    std::vector<Candidate> found;
    found.reserve(costs.size());
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const auto place = static_cast<std::int32_t>(i);
        found.push_back(
            {costs[i],
             {band.margin + place % columns * band.factor, band.margin + place / columns * band.factor}});
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

FoundContents search_patch(const Pyramid& pyramid, const PerceptualImage& tile_colors,
                           const PeriodicTile& tile, const Segmentation& segmentation, std::size_t patch,
                           const ContentSearch& search, std::int32_t coarsest) {
    const auto& box = segmentation.patches[patch];
    const PerceptualImage& photo = pyramid.at(1);
    // Three texels beyond the blending: what the eye compares across the border
    const std::int32_t reach = search.blend_texels / 2 + 3;
    const auto wanted = static_cast<std::size_t>(search.contents);
    const std::vector<Offset> own = own_places(tile, segmentation, patch);

    // Exhaustively where the photograph is small; a coarser grid is useless if the band does not fit into it
    std::int32_t factor = coarsest;
    BorderBand band = make_border_band(tile_colors, segmentation, patch, reach, factor);
    std::vector<Candidate> everywhere = search_coarsely(band, pyramid.at(factor));
    while (everywhere.size() < 4 * wanted && factor > 1) {
        factor /= 2;
        band = make_border_band(tile_colors, segmentation, patch, reach, factor);
        everywhere = search_coarsely(band, pyramid.at(factor));
    }

    // More than wanted, since their order changes as they are refined; closer together only if there is no
    // choice
    std::int32_t distance = std::max(4, std::min(box.width, box.height) / 3);
    std::vector<Candidate> candidates;
    for (;; distance /= 2) {
        candidates = spread(everywhere, own, distance + factor, 3 * wanted + 8);
        if (candidates.size() >= wanted || distance <= 2) break;
    }
    everywhere = {};
    while (factor > 1) {
        factor /= 2;
        band = make_border_band(tile_colors, segmentation, patch, reach, factor);
        const PerceptualImage& level = pyramid.at(factor);
        const Span across = span_of(photo.width, band.width, band);
        const Span down = span_of(photo.height, band.height, band);
        for (Candidate& candidate : candidates) refine(candidate, band, level, across, down);
    }
    for (Candidate& candidate : candidates)
        candidate.cost = mean_difference(band, photo, candidate.at.x, candidate.at.y);
    std::sort(candidates.begin(), candidates.end());

    FoundContents out;
    for (const Candidate& candidate : spread(candidates, own, std::max(1, distance), wanted)) {
        out.offsets.push_back(candidate.at);
        out.costs.push_back(candidate.cost);
    }
    return out;
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

std::vector<FoundContents> find_contents(const PerceptualImage& photo, const PerceptualImage& tile_colors,
                                         const PeriodicTile& tile, const Segmentation& segmentation,
                                         const ContentSearch& search, Progress& progress) {
    const std::int32_t coarsest = coarsest_factor(photo, segmentation, tile.side, search.blend_texels);
    Pyramid pyramid;
    for (std::int32_t factor = 1; factor <= coarsest; factor *= 2) pyramid[factor] = reduced(photo, factor);

    std::vector<FoundContents> found(segmentation.patches.size());
    std::atomic<std::size_t> done{0};
    for_each_index(found.size(), search.threads, [&](std::size_t patch) {
        if (progress.stop().stop_requested()) return;
        found[patch] = search_patch(pyramid, tile_colors, tile, segmentation, patch, search, coarsest);
        progress.advance("contents", static_cast<double>(++done) / static_cast<double>(found.size()));
    });
    return found;
}

}  // namespace tessera
