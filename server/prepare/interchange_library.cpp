#include "server/prepare/interchange_library.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "server/prepare/interchange_layer.h"
#include "server/prepare/interchange_places.h"
#include "server/prepare/parallel.h"
#include "server/prepare/seam.h"

namespace tessera {
namespace {

/// Grains are a tenth of the tile wide: smaller ones have longer borders to hide, larger ones leave less to
/// mix.
constexpr std::int32_t grains_a_side = 10, least_grain = 8;

/// Whether two patches show the same where they overlap, or nearly, and that is a good part of either.
bool alike(const InterchangePatch& a, const InterchangePatch& b, std::int32_t tile_side) {
    const std::int32_t wrap = tile_side - 1;
    // b moved by whole tiles to where it comes closest to a
    const std::int32_t dx = ((b.x - a.x + tile_side / 2) & wrap) - tile_side / 2;
    const std::int32_t dy = ((b.y - a.y + tile_side / 2) & wrap) - tile_side / 2;
    if (std::abs(b.at.x - dx - a.at.x) >= 4 || std::abs(b.at.y - dy - a.at.y) >= 4) return false;
    std::int32_t both = 0;
    for (std::int32_t y = std::max(0, dy); y < std::min(a.height, dy + b.height); ++y)
        for (std::int32_t x = std::max(0, dx); x < std::min(a.width, dx + b.width); ++x)
            both += a.shape.at(x, y) && b.shape.at(x - dx, y - dy);
    return both * 4 > std::min(a.texels, b.texels);
}

/// How many patches lie on each texel of the tile.
class Coverage {
  public:
    explicit Coverage(std::int32_t side)
        : side_{side}, counts_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)) {}

    void add(const InterchangePatch& patch, std::int32_t by) {
        for_each(patch, [&](std::int32_t& count) { count += by; });
        texels_ += std::int64_t{by} * patch.texels;
    }
    std::int32_t least(const InterchangePatch& patch) {
        std::int32_t least = INT32_MAX;
        for_each(patch, [&](std::int32_t count) { least = std::min(least, count); });
        return least;
    }
    std::int64_t mean() const { return texels_ / std::ssize(counts_); }

  private:
    template <class Call>
    void for_each(const InterchangePatch& patch, Call&& call) {
        for (std::int32_t y = 0; y < patch.height; ++y)
            for (std::int32_t x = 0; x < patch.width; ++x)
                if (patch.shape.at(x, y))
                    call(counts_[static_cast<std::size_t>(((patch.y + y) & (side_ - 1)) * side_ +
                                                          ((patch.x + x) & (side_ - 1)))]);
    }
    std::int32_t side_;
    std::int64_t texels_ = 0;
    std::vector<std::int32_t> counts_;
};

/// Leaves the wanted number, the best by their highest price (Kolář et al. 2016, section 4.1), each among
/// those of about its size: longer borders have higher prices somewhere, and large patches show least of the
/// tile. But all of those that lie where there are few, since otherwise what is hard to match, such as the
/// tile's own boldest features, would show everywhere.
void leave_out_worst(std::vector<InterchangePatch>& library, std::size_t wanted, std::int32_t tile_side) {
    if (library.size() <= wanted) return;
    Coverage coverage{tile_side};
    for (const InterchangePatch& patch : library) coverage.add(patch, 1);
    std::array<std::vector<std::size_t>, 32> by_size;
    for (std::size_t p = 0; p < library.size(); ++p)
        by_size[static_cast<std::size_t>(std::bit_width(static_cast<std::uint32_t>(library[p].texels)))]
            .push_back(p);
    std::vector<std::pair<std::uint64_t, std::size_t>> ranks;  // among its size, in 2^32nds; the worst first
    for (auto& size : by_size) {
        std::sort(size.begin(), size.end(), [&](std::size_t p, std::size_t q) {
            return std::tuple{library[q].worst, p} < std::tuple{library[p].worst, q};
        });
        for (std::size_t i = 0; i < size.size(); ++i)
            ranks.emplace_back((std::uint64_t{i} << 32) / size.size(), size[i]);
    }
    std::sort(ranks.begin(), ranks.end());
    std::vector<std::uint8_t> dropped(library.size());
    std::size_t left = library.size();
    for (const bool only_where_many : {true, false})
        for (const auto& [rank, p] : ranks) {
            if (left == wanted) break;
            if (dropped[p] != 0 || (only_where_many && coverage.least(library[p]) < coverage.mean()))
                continue;
            coverage.add(library[p], -1);
            dropped[p] = 1;
            --left;
        }
    std::size_t p = 0;
    std::erase_if(library, [&](const InterchangePatch&) { return dropped[p++] != 0; });
}

}  // namespace

std::vector<InterchangePatch> find_library(const PerceptualImage& photo, const QuiltedTile& tile,
                                           const LibrarySearch& search, Progress& progress) {
    // Room to be moved about in, also for the largest
    const std::int32_t room = (std::min(photo.width, photo.height) - search.blend_texels) * 5 / 8;
    const std::int32_t grain =
        std::min(std::max(tile.side / grains_a_side, least_grain), std::max(4, room / 3));
    const std::int32_t grain_count = std::max(16, tile.side / grain * (tile.side / grain));
    const PlaceSearch places{photo, tile, search.blend_texels / 2};
    const std::int32_t margin = (grain / 2 + 3) / 4 * 4;
    // A layer has about four regions for ten grains, and two patches for each
    const std::int32_t patches_a_layer = std::max(1, grain_count * 4 / 5);
    const auto layers = static_cast<std::size_t>(std::max(2, search.patches / patches_a_layer));
    const std::int32_t largest = std::min(tile.side * 30 / 64, room - 2 * margin) / 8 * 8;
    const std::uint32_t gradient = mean_gradient(photo);
    const auto most = static_cast<std::size_t>(search.patches) * 2 / layers;
    std::vector<std::vector<InterchangePatch>> found(layers);
    std::atomic<std::size_t> done{0};
    for_each_index(layers, search.threads, [&](std::size_t i) {
        const Segmentation grains = make_patches(tile.colors, grain_count, search.seed + i);
        const LayerSources sources{
            photo,       tile,           grains, places, gradient, margin, std::max(8, largest),
            search.seed, progress.stop()};
        found[i] = make_layer(sources, static_cast<std::int32_t>(i), most);
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
    leave_out_worst(library, static_cast<std::size_t>(search.patches), tile.side);
    return library;
}

}  // namespace tessera
