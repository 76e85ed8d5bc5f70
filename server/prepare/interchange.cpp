#include <algorithm>
#include <map>
#include <string>
#include <thread>

#include "server/prepare/interchange_groups.h"
#include "server/prepare/interchange_library.h"
#include "server/prepare/interchange_sets.h"
#include "server/prepare/prepare.h"
#include "server/prepare/quilting.h"

namespace tessera {
namespace {

using Standing = ExchangeAsset::Standing;

constexpr std::int32_t least_tile_side = 16, most_tile_side = 4096;
constexpr std::int32_t least_patches = 16, most_patches = 4000;

Error invalid(std::string what) { return {ErrorCode::invalid_input, std::move(what)}; }

Result<void> check_range(const char* option, std::int32_t value, std::int32_t least, std::int32_t most) {
    if (value >= least && value <= most) return {};
    return invalid(std::string{option} + " is " + std::to_string(value) + "; from " + std::to_string(least) +
                   " to " + std::to_string(most));
}

Result<PrepareOptions> checked(const Rgb8Image& photo, PrepareOptions options, Progress& progress) {
    if (options.tile_side == 0) options.tile_side = 256;
    // They fill what groups leave
    if (options.patches == 0)
        options.patches = static_cast<std::int32_t>(std::clamp(std::int64_t{photo.width} * photo.height / 200,
                                                               std::int64_t{300}, std::int64_t{1200}));
    if (options.blend_texels == -1) options.blend_texels = 4;
    if (options.threads == 0) options.threads = std::max(1u, std::thread::hardware_concurrency());
    if (auto good = check_range("--tile", options.tile_side, least_tile_side, most_tile_side); !good)
        return good.error();
    if ((options.tile_side & (options.tile_side - 1)) != 0)
        return invalid("--tile is " + std::to_string(options.tile_side) +
                       "; a power of two, such as 256 or 512");
    if (auto good = check_range("--patches", options.patches, least_patches, most_patches); !good)
        return good.error();
    if (auto good = check_range("--blend", options.blend_texels, 0, 64); !good) return good.error();
    if (options.blend_texels % 2 != 0)
        return invalid("--blend is " + std::to_string(options.blend_texels) + "; an even number of texels");

    const std::int32_t room = std::min(photo.width, photo.height);
    if (room < least_quilted_photo)
        return invalid("is " + std::to_string(photo.width) + "×" + std::to_string(photo.height) +
                       " texels, too small for a tile; " + std::to_string(least_quilted_photo) +
                       " a side are the least");
    // Squares of 8 texels and the blending around them need room to be moved in
    const std::int32_t widest = std::min((room - 16) / 2 * 2, options.tile_side / 4);
    if (options.blend_texels > widest) {
        progress.note("blending over " + std::to_string(options.blend_texels) +
                      " texels is too wide for a tile of " + std::to_string(options.tile_side) +
                      " and a photograph of " + std::to_string(photo.width) + "×" +
                      std::to_string(photo.height) + ": it is " + std::to_string(widest));
        options.blend_texels = widest;
    }
    return options;
}

ExchangeAsset::Patch to_patch(const InterchangePatch& from, Standing standing) {
    return {from.x,
            from.y,
            from.width,
            from.height,
            {{from.at, from.shape, standing, 0}},
            ExchangeAsset::Set::none,
            0};
}

/// A group of an earlier preparation, and what a person said of its patches.
struct JudgedGroup {
    InterchangeGroup group;
    std::vector<Standing> standings;  ///< Of each patch.

    bool has(Standing standing) const {
        return std::find(standings.begin(), standings.end(), standing) != standings.end();
    }
};

/// Adds groups to an asset, numbered from 1 on.
class GroupWriter {
  public:
    explicit GroupWriter(ExchangeAsset& asset) : asset_{asset} {}
    void add(const InterchangeGroup& group, const std::vector<Standing>& standings) {
        ++number_;
        for (std::size_t p = 0; p < group.patches.size(); ++p) {
            asset_.patches.push_back(
                to_patch(group.patches[p], standings.empty() ? Standing::chosen : standings[p]));
            asset_.patches.back().group = number_;
        }
    }

  private:
    ExchangeAsset& asset_;
    std::uint16_t number_ = 0;
};

InterchangePatch from_patch(const ExchangeAsset::Patch& from, std::int32_t tile_side) {
    InterchangePatch patch;
    patch.x = from.x;
    patch.y = from.y;
    patch.width = from.width;
    patch.height = from.height;
    patch.at = from.contents[0].at;
    patch.shape = from.contents[0].shape;
    for (std::int32_t y = 0; y < from.height; ++y)
        for (std::int32_t x = 0; x < from.width; ++x)
            if (patch.shape.at(x, y)) {
                ++patch.texels;
                patch.in_rhombus &= in_rhombus(from.x + x, from.y + y, tile_side);
            }
    return patch;
}

}  // namespace

Result<PreparedAsset> prepare_interchange(const Rgb8Image& photo, const PrepareOptions& asked,
                                          const ExchangeAsset* before, Progress& progress) {
    const auto options = checked(photo, asked, progress);
    if (!options) return options.error();
    const Error stopped{ErrorCode::cancelled, "the preparation was stopped"};
    const PerceptualImage colors = to_perceptual(photo);

    QuiltedTile tile = quilt_tile(colors, options->tile_side, options->seed, options->threads, progress);
    if (progress.stop().stop_requested()) return stopped;
    PreparedAsset made;
    ExchangeAsset& asset = made.asset;
    asset.method = ExchangeMethod::interchange;
    asset.exemplar = photo;
    asset.tile_side = options->tile_side;
    asset.blend_texels = options->blend_texels;
    asset.tile = {tile.side, tile.side, {}};
    for (const PhotoPoint from : tile.sources) {
        const auto at = 3 * (static_cast<std::ptrdiff_t>(from.y) * photo.width + from.x);
        asset.tile.bytes.insert(asset.tile.bytes.end(), photo.bytes.begin() + at,
                                photo.bytes.begin() + at + 3);
    }

    // What a person said of the patches of an earlier preparation
    std::map<std::uint16_t, JudgedGroup> judged;
    LibrarySearch search{options->patches, options->blend_texels, options->seed, options->threads, {}, {}};
    if (before != nullptr) {
        if (before->tile_side != asset.tile_side || before->tile.bytes != asset.tile.bytes)
            return invalid("the asset to go on from has another tile; prepare with its own options and seed");
        for (const ExchangeAsset::Patch& patch : before->patches) {
            if (patch.group != 0) {
                JudgedGroup& group = judged[patch.group];
                group.group.patches.push_back(from_patch(patch, asset.tile_side));
                group.standings.push_back(patch.contents[0].standing);
                continue;
            }
            if (patch.contents[0].standing == Standing::pinned)
                search.given.push_back(from_patch(patch, asset.tile_side));
            if (patch.contents[0].standing == Standing::dropped)
                search.unwanted.push_back(from_patch(patch, asset.tile_side));
        }
        search.patches = std::max(search.patches - static_cast<std::int32_t>(search.given.size()), 0);
    }
    std::vector<InterchangePatch> library = find_library(colors, tile, search, progress);
    if (progress.stop().stop_requested()) return stopped;
    GroupSearch group_search{
        options->patches, options->blend_texels, options->seed, options->threads, {}, {}};
    for (const auto& [number, group] : judged)
        if (group.has(Standing::dropped))
            group_search.unwanted.push_back(group.group);
        else if (group.has(Standing::pinned))
            group_search.given.push_back(group.group);
    const std::vector<InterchangeGroup> groups = find_groups(colors, tile, group_search, progress);
    if (progress.stop().stop_requested()) return stopped;
    if (groups.empty() && group_search.given.empty())
        progress.note(
            "patches are not grouped, since the photograph is too small or the tile too large for "
            "it: the tile stays in sight between them");

    for (const InterchangePatch& patch : library) asset.patches.push_back(to_patch(patch, Standing::chosen));
    for (const InterchangePatch& patch : search.given) {
        asset.patches.push_back(to_patch(patch, Standing::pinned));
        library.push_back(patch);
    }
    progress.advance("sets", 0);
    const auto sets = divide_into_sets(library, asset.tile_side, options->seed);
    for (std::size_t p = 0; p < library.size(); ++p) asset.patches[p].set = sets[p];
    GroupWriter writer{asset};
    for (const InterchangeGroup& group : groups) writer.add(group, {});
    for (const auto& [number, group] : judged)
        if (group.has(Standing::dropped) || group.has(Standing::pinned))
            writer.add(group.group, group.standings);
    for (const InterchangePatch& patch : search.unwanted)
        asset.patches.push_back(to_patch(patch, Standing::dropped));
    progress.advance("sets", 1);
    if (std::ssize(library) < options->patches * 3 / 4 && search.patches > 0)
        progress.note("the library has " + std::to_string(library.size()) + " patches, fewer than the " +
                      std::to_string(options->patches) + " asked for: no more fit well");
    made.tile_sources = std::move(tile.sources);
    return made;
}

}  // namespace tessera
