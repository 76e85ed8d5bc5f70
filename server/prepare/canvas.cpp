#include "server/prepare/canvas.h"

#include <algorithm>
#include <tuple>

#include "server/prepare/graph_cut.h"
#include "server/prepare/seam.h"

namespace tessera {
namespace {

/// A texel of the block that lies on something: what a block must match.
struct Known {
    std::int32_t x = 0, y = 0;
    PerceptualColor color;
};

/// Every `stride`-th, rows set off against each other.
std::vector<Known> known_texels(const Canvas& canvas, const CanvasBlock& block, std::int32_t stride) {
    std::vector<Known> known;
    for (std::int32_t y = 0; y < block.height; y += stride)
        for (std::int32_t x = (y / stride % 2) * (stride / 2); x < block.width; x += stride) {
            const std::size_t i = canvas.index(block.x + x, block.y + y);
            if (canvas.laid[i] != 0) known.push_back({x, y, canvas.colors[i]});
        }
    return known;
}

std::uint64_t misfit(const PerceptualImage& photo, const std::vector<Known>& known, PhotoPoint at) {
    std::uint64_t sum = 0;
    for (const Known& texel : known)
        sum += static_cast<std::uint64_t>(difference(texel.color, photo.at(at.x + texel.x, at.y + texel.y)));
    return sum;
}

struct Place {
    std::uint64_t misfit = 0;
    PhotoPoint at;
    bool operator<(const Place& other) const {
        return std::tuple{misfit, at.y, at.x} < std::tuple{other.misfit, other.at.y, other.at.x};
    }
};

}  // namespace

Canvas::Canvas(std::int32_t w, std::int32_t h, bool on_torus) : width{w}, height{h}, wraps{on_torus} {
    const auto texels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    sources.resize(texels);
    colors.resize(texels);
    laid.resize(texels);
}

PlaceWindow all_places(const PerceptualImage& photo, const CanvasBlock& block) {
    return {0, 0, photo.width - block.width + 1, photo.height - block.height + 1};
}

std::vector<PhotoPoint> best_places(const PerceptualImage& photo, const Canvas& canvas,
                                    const CanvasBlock& block, const PlaceWindow& window, std::size_t count) {
    constexpr std::size_t most_kept = 24;
    std::int32_t step = 1;
    while (step < 8 && std::max(block.width, block.height) / step > 24) step *= 2;
    std::vector<Place> places;
    const std::vector<Known> sparse = known_texels(canvas, block, 2 * step);
    for (std::int32_t y = 0; y < window.height; y += step)
        for (std::int32_t x = 0; x < window.width; x += step) {
            const PhotoPoint at{window.x + x, window.y + y};
            places.push_back({misfit(photo, sparse, at), at});
        }
    const std::size_t kept = std::min(places.size(), most_kept);
    std::partial_sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(kept), places.end());
    places.resize(kept);
    const PlaceWindow all = all_places(photo, block);
    while (step > 1) {
        step /= 2;
        const std::vector<Known> known = known_texels(canvas, block, step);
        for (Place& place : places) {
            const PhotoPoint centre = place.at;
            place.misfit = misfit(photo, known, centre);
            for (std::int32_t i = 0; i < 9; ++i) {
                const PhotoPoint at{centre.x + (i % 3 - 1) * step, centre.y + (i / 3 - 1) * step};
                if (at.x < 0 || at.y < 0 || at.x >= all.width || at.y >= all.height) continue;
                place = std::min(place, Place{misfit(photo, known, at), at});
            }
        }
    }
    std::sort(places.begin(), places.end());
    std::vector<PhotoPoint> best;
    for (const Place& place : places)
        if (best.size() < count && std::find(best.begin(), best.end(), place.at) == best.end())
            best.push_back(place.at);
    return best;
}

void lay_block(Canvas& canvas, const PerceptualImage& photo, const CanvasBlock& block, PhotoPoint at,
               BlockRim rim) {
    CutGrid grid{block.width, block.height};
    const auto texel = [&](std::int32_t x, std::int32_t y) { return canvas.index(block.x + x, block.y + y); };
    const auto price = [&](std::int32_t x, std::int32_t y, std::int32_t u, std::int32_t v) -> std::uint32_t {
        const std::size_t s = texel(x, y), t = texel(u, v);
        if (canvas.laid[s] == 0 && canvas.laid[t] == 0) return 0;
        const PerceptualColor a_s = photo.at(at.x + x, at.y + y), a_t = photo.at(at.x + u, at.y + v);
        const PerceptualColor b_s = canvas.colors[s], b_t = canvas.colors[t];
        if (canvas.laid[s] != 0 && canvas.laid[t] != 0) return seam_price(a_s, a_t, b_s, b_t);
        // Where nothing lies the block will: a border there is seen from one side, and costs as if from both
        return canvas.laid[s] != 0 ? 2 * distance(b_s, a_t) + 2 * distance(a_s, b_s) + 1
                                   : 2 * distance(a_s, b_t) + 2 * distance(a_t, b_t) + 1;
    };
    const auto on_rim = [&](std::int32_t x, std::int32_t y) {
        const bool beside = x == 0 || x == block.width - 1, over = y == 0 || y == block.height - 1;
        return (beside && rim != BlockRim::top_and_bottom) || (over && rim != BlockRim::left_and_right);
    };
    for (std::int32_t y = 0; y < block.height; ++y)
        for (std::int32_t x = 0; x < block.width; ++x) {
            const std::size_t i = grid.index(x, y);
            if (canvas.laid[texel(x, y)] == 0)
                grid.outside[i] = CutGrid::must;
            else if (on_rim(x, y))
                grid.inside[i] = CutGrid::must;
            if (x + 1 < block.width) grid.right[i] = price(x, y, x + 1, y);
            if (y + 1 < block.height) grid.below[i] = price(x, y, x, y + 1);
        }
    const ShapeCut cut = cheapest_shape(grid);
    for (std::int32_t y = 0; y < block.height; ++y)
        for (std::int32_t x = 0; x < block.width; ++x)
            if (cut.shape.at(x, y)) canvas.put(block.x + x, block.y + y, {at.x + x, at.y + y}, photo);
    canvas.seam_cost += cut.cost;
}

void lay_cheapest(Canvas& canvas, const PerceptualImage& photo, const CanvasBlock& block,
                  const std::vector<PhotoPoint>& places, BlockRim rim) {
    Canvas cheapest = canvas;
    for (std::size_t i = 0; i < places.size(); ++i) {
        Canvas tried = canvas;
        lay_block(tried, photo, block, places[i], rim);
        if (i == 0 || tried.seam_cost < cheapest.seam_cost) cheapest = std::move(tried);
    }
    canvas = std::move(cheapest);
}

}  // namespace tessera
