#include "server/prepare/interchange_library.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <tuple>

#include "server/prepare/interchange_layer.h"
#include "server/prepare/interchange_places.h"
#include "server/prepare/parallel.h"
#include "server/prepare/seam.h"

namespace tessera {
namespace {

/// About so many patches make a layer.
constexpr std::int32_t patches_a_layer = 60;

/// Whether two patches overlap and show the same there, or nearly.
bool alike(const InterchangePatch& a, const InterchangePatch& b, std::int32_t tile_side) {
    const std::int32_t wrap = tile_side - 1;
    // b moved by whole tiles to where it comes closest to a
    const std::int32_t dx = ((b.x - a.x + tile_side / 2) & wrap) - tile_side / 2;
    const std::int32_t dy = ((b.y - a.y + tile_side / 2) & wrap) - tile_side / 2;
    if (dx >= a.width || dy >= a.height || -dx >= b.width || -dy >= b.height) return false;
    return std::abs(b.at.x - dx - a.at.x) < 4 && std::abs(b.at.y - dy - a.at.y) < 4;
}

/// What texels pay, from what the photograph's own texels differ by: the more, the closer patches lie
/// together and the more their borders show.
std::uint32_t pull_for(const PerceptualImage& photo) {
    std::uint64_t sum = 0, pairs = 0;
    for (std::int32_t y = 0; y + 1 < photo.height; ++y)
        for (std::int32_t x = 0; x + 1 < photo.width; ++x, pairs += 2)
            sum +=
                distance(photo.at(x, y), photo.at(x + 1, y)) + distance(photo.at(x, y), photo.at(x, y + 1));
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(sum / pairs * 3 / 2, 16));
}

}  // namespace

std::vector<InterchangePatch> find_library(const PerceptualImage& photo, const QuiltedTile& tile,
                                           const LibrarySearch& search, Progress& progress) {
    const std::int32_t room = std::min(photo.width, photo.height) - search.blend_texels;
    const PlaceSearch places{photo, tile, search.blend_texels / 2};
    const LayerSources sources{photo,
                               tile,
                               places,
                               pull_for(photo),
                               std::max(8, std::min(tile.side * 5 / 8, room / 2) / 8 * 8),
                               search.seed,
                               progress.stop()};
    const auto layers = static_cast<std::size_t>(std::max(2, search.patches / patches_a_layer));
    const auto most = static_cast<std::size_t>(search.patches) * 2 / layers;
    std::vector<std::vector<InterchangePatch>> found(layers);
    std::atomic<std::size_t> done{0};
    for_each_index(layers, search.threads, [&](std::size_t i) {
        found[i] = make_layer(sources, static_cast<std::int64_t>(i), most);
        progress.advance("patches", static_cast<double>(++done) / static_cast<double>(layers));
    });
    if (progress.stop().stop_requested()) return {};

    // All that are unlike each other, and of these the best by their highest price
    std::vector<InterchangePatch> library;
    for (auto& layer : found)
        for (InterchangePatch& patch : layer) {
            const auto like_this = [&](const InterchangePatch& other) {
                return alike(patch, other, tile.side);
            };
            if (std::none_of(library.begin(), library.end(), like_this) &&
                std::none_of(search.given.begin(), search.given.end(), like_this) &&
                std::none_of(search.unwanted.begin(), search.unwanted.end(), like_this))
                library.push_back(std::move(patch));
        }
    const auto wanted = static_cast<std::size_t>(search.patches);
    if (library.size() > wanted) {
        std::vector<std::uint32_t> worst;
        for (const InterchangePatch& patch : library) worst.push_back(patch.worst);
        std::nth_element(worst.begin(), worst.begin() + static_cast<std::ptrdiff_t>(wanted - 1), worst.end());
        const std::uint32_t limit = worst[wanted - 1];
        std::erase_if(library, [&](const InterchangePatch& patch) { return patch.worst > limit; });
        library.resize(std::min(library.size(), wanted));
    }
    return library;
}

}  // namespace tessera
