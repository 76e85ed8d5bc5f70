#include <algorithm>
#include <string>
#include <thread>

#include "server/prepare/contents.h"
#include "server/prepare/judged_contents.h"
#include "server/prepare/painted_patches.h"
#include "server/prepare/patches.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/prepare.h"
#include "server/prepare/quilting.h"
#include "server/prepare/tile.h"

namespace tessera {
namespace {

constexpr std::int32_t least_tile_side = 16;
constexpr std::int32_t least_photo_side = least_quilted_photo;
constexpr std::int32_t least_patches = 16;
constexpr std::int32_t most_patches = 256;

/// The tile that is made of a photograph unless another is asked for: as large as it, since large patches
/// show less of the tile along their borders, but no larger than takes some seconds.
std::int32_t usual_tile_side(const Rgb8Image& photo) {
    std::int32_t side = least_tile_side;
    while (side < 512 && 2 * side <= std::min(photo.width, photo.height) * 9 / 8) side *= 2;
    return side;
}

/// What is asked for, and the method's own numbers where nothing is.
PrepareOptions with_defaults(PrepareOptions options, const Rgb8Image& photo) {
    if (options.tile_side == 0) options.tile_side = usual_tile_side(photo);
    if (options.patches == 0) options.patches = 16;
    if (options.contents == 0) options.contents = 24;
    if (options.blend_texels == -1) options.blend_texels = 4;
    if (options.threads == 0) options.threads = std::max(1u, std::thread::hardware_concurrency());
    return options;
}

Error invalid(std::string what) { return {ErrorCode::invalid_input, std::move(what)}; }

Result<void> check_range(const char* option, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value < least || value > most)
        return invalid(std::string{option} + " is " + std::to_string(value) + "; from " +
                       std::to_string(least) + " to " + std::to_string(most));
    return {};
}

Result<void> check(const PrepareOptions& options) {
    if (auto good = check_range("--tile", options.tile_side, least_tile_side, 4096); !good) return good;
    if ((options.tile_side & (options.tile_side - 1)) != 0)
        return invalid("--tile is " + std::to_string(options.tile_side) +
                       "; a power of two, such as 256 or 512");
    if (auto good = check_range("--patches", options.patches, least_patches, most_patches); !good)
        return good;
    if (auto good = check_range("--contents", options.contents, 1, ExchangeAsset::max_contents); !good)
        return good;
    if (auto good = check_range("--blend", options.blend_texels, 0, 64); !good) return good;
    if (options.blend_texels % 2 != 0)
        return invalid("--blend is " + std::to_string(options.blend_texels) + "; an even number of texels");
    // What a server refuses to load is not worth preparing; boxes cover a tile some two and a half times
    const std::size_t texels = std::size_t(options.tile_side) * std::size_t(options.tile_side) * 5 / 2;
    if (const std::size_t bytes = texels * (std::size_t(options.contents) * 6 + 18);
        bytes > max_exchange_bytes)
        return invalid("--tile " + std::to_string(options.tile_side) + " with --contents " +
                       std::to_string(options.contents) + " would take about " + std::to_string(bytes >> 20) +
                       " MiB when served, more than " + std::to_string(max_exchange_bytes >> 20) +
                       "; ask for a smaller tile or fewer contents");
    return {};
}

/// The options that this photograph allows; every change is noted.
Result<PrepareOptions> fitted(const Rgb8Image& photo, PrepareOptions options, Progress& progress) {
    // Boxes are up to half a tile wide
    const std::int32_t room = std::min(photo.width, photo.height);
    const std::int32_t asked = options.tile_side;
    while (options.tile_side > least_tile_side && options.tile_side > room * 9 / 8) options.tile_side /= 2;
    const std::string size = std::to_string(photo.width) + "×" + std::to_string(photo.height);
    if (room < least_photo_side)
        return invalid("is " + size + " texels, too small for a tile; " + std::to_string(least_photo_side) +
                       " a side are the least");
    if (options.tile_side < asked)
        progress.note("the photograph of " + size + " is too small for a tile of " + std::to_string(asked) +
                      ": it is " + std::to_string(options.tile_side));
    if (options.tile_side < asked && !options.patch_map.empty())
        return invalid("is " + size + " texels, too small for the patch map's tile of " +
                       std::to_string(asked) + "; use a larger photograph, or a map of " +
                       std::to_string(options.tile_side) + " a side");

    const std::int32_t widest_blend = options.tile_side / 4;
    if (options.blend_texels > widest_blend) {
        progress.note("blending over " + std::to_string(options.blend_texels) +
                      " texels is too wide for a tile of " + std::to_string(options.tile_side) + ": it is " +
                      std::to_string(widest_blend));
        options.blend_texels = widest_blend;
    }
    // Patches as large as asked for, so fewer of them on a smaller tile
    const std::int32_t smaller = asked / options.tile_side;
    const std::int32_t of_same_size = std::max(least_patches, options.patches / (smaller * smaller));
    if (of_same_size < options.patches && smaller > 1) {
        progress.note("on the smaller tile there are about " + std::to_string(of_same_size) +
                      " patches, not " + std::to_string(options.patches));
        options.patches = of_same_size;
    }
    // A patch three times as wide as its blending shows something of its own; four by four are the fewest
    const std::int32_t per_side = std::max(4, options.tile_side / std::max(8, 3 * options.blend_texels));
    if (options.patches > per_side * per_side) {
        progress.note("a tile of " + std::to_string(options.tile_side) + " has no room for " +
                      std::to_string(options.patches) + " patches: there are about " +
                      std::to_string(per_side * per_side));
        options.patches = per_side * per_side;
    }
    return options;
}

/// A tile out of one piece of the photograph, or, where that is too small, quilted of many.
PeriodicTile cut_tile(const PerceptualImage& photo, const PrepareOptions& options, Progress& progress) {
    const std::int32_t side = options.tile_side;
    if (side + least_overlap(side) <= std::min(photo.width, photo.height))
        return make_tile(photo, side, options.threads, progress);
    QuiltedTile quilted = quilt_tile(photo, side, options.seed, options.threads, progress);
    return {side, 0, std::move(quilted.sources), quilted.seam_cost};
}

/// The patches: a person's, or grown.
Result<Segmentation> divide(const PerceptualImage& tile, const PrepareOptions& options) {
    if (options.patch_map.empty())
        return make_patches(tile, options.patches, options.seed, BorderPlaces::quiet_and_of_mean_lightness);
    return painted_patches(options.patch_map, tile.width);
}

/// What a person said of each patch's contents, if `before` has the same patches.
Result<std::vector<JudgedContents>> judged_contents(const ExchangeAsset* before,
                                                    const Segmentation& segmentation,
                                                    std::int32_t blend_texels) {
    std::vector<JudgedContents> judged(segmentation.patches.size());
    if (before == nullptr) return judged;
    if (before->labels != segmentation.labels || before->blend_texels < blend_texels)
        return invalid(
            "gives other patches than before, so that nothing pinned or dropped could be kept; prepare it "
            "afresh, without --continue");
    std::ranges::transform(before->patches, judged.begin(),
                           [](const auto& patch) { return JudgedContents{patch}; });
    return judged;
}

Result<void> take_contents(const std::vector<std::vector<ShapedContent>>& found,
                           const std::vector<JudgedContents>& judged, std::int32_t wanted,
                           ExchangeAsset& asset, Progress& progress) {
    std::size_t fewest = ~std::size_t{0}, short_of = 0;
    for (std::size_t p = 0; p < found.size(); ++p) {
        auto& contents = asset.patches[p].contents;
        contents = judged[p].with(found[p], wanted);
        const auto shown = std::size_t(std::ranges::count_if(contents, [](const auto& content) {
            return content.standing != ExchangeAsset::Standing::dropped;
        }));
        fewest = std::min(fewest, shown);
        short_of += shown < static_cast<std::size_t>(wanted) ? 1 : 0;
        if (contents.size() > std::size_t{ExchangeAsset::max_contents})
            return invalid("has " + std::to_string(contents.size()) + " contents for patch " +
                           std::to_string(p) + ", dropped ones with them; at most " +
                           std::to_string(ExchangeAsset::max_contents) + ", so ask for fewer");
    }
    if (fewest == 0)
        return invalid(
            "is too small to find another content for every patch; use a larger photograph, or --tile " +
            std::to_string(std::max(least_tile_side, asset.tile_side / 2)) + " or more --patches");
    if (short_of > 0)
        progress.note(std::to_string(short_of) + " of " + std::to_string(found.size()) +
                      " patches have fewer than " + std::to_string(wanted) + " contents (the fewest " +
                      std::to_string(fewest) + "): the photograph holds no more that are distinct");
    return {};
}

}  // namespace

Result<PreparedAsset> prepare_content_exchange(const Rgb8Image& photo, const PrepareOptions& asked,
                                               const ExchangeAsset* before, Progress& progress) {
    const PrepareOptions complete = with_defaults(asked, photo);
    if (auto good = check(complete); !good) return good.error();
    const auto options = fitted(photo, complete, progress);
    if (!options) return options.error();
    const Error stopped{ErrorCode::cancelled, "stopped before the asset was complete"};
    const PerceptualImage colors = to_perceptual(photo);

    // Cut a tile that repeats without a visible edge
    const PeriodicTile tile = cut_tile(colors, *options, progress);
    if (progress.stop().stop_requested()) return stopped;
    ExchangeAsset asset;
    asset.tile = cut_out(photo, tile);
    asset.tile_side = tile.side;
    asset.blend_texels = options->blend_texels;

    // Divide it into patches
    progress.advance("patches", 0);
    const PerceptualImage tile_colors = to_perceptual(asset.tile);
    auto segmentation = divide(tile_colors, *options);
    if (!segmentation) return segmentation.error();
    const auto judged = judged_contents(before, *segmentation, options->blend_texels);
    if (!judged) return judged.error();
    progress.advance("patches", 1);
    if (progress.stop().stop_requested()) return stopped;

    // Find what else of the photograph each patch may show, beside what a person has judged
    const std::int32_t most_judged = std::ranges::max(*judged, {}, &JudgedContents::count).count();
    const std::vector<std::vector<ShapedContent>> found =
        find_contents(colors, tile_colors, tile, *segmentation,
                      {options->contents + most_judged, options->blend_texels, options->threads}, progress);
    if (progress.stop().stop_requested()) return stopped;
    asset.labels = std::move(segmentation->labels);
    asset.patches = std::move(segmentation->patches);
    if (auto taken = take_contents(found, *judged, options->contents, asset, progress); !taken)
        return taken.error();
    asset.exemplar = photo;
    return PreparedAsset{std::move(asset), tile.sources, {}};
}

}  // namespace tessera
