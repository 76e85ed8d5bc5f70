#include "server/scene/asset_check.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "server/scene/shape_sheet.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using Patch = ExchangeAsset::Patch;
using Set = ExchangeAsset::Set;

constexpr const char* again = "; prepare the photograph again";

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

std::string name_of(std::size_t patch) { return "patches_info[" + std::to_string(patch) + "]"; }

std::string name_of(std::size_t patch, std::size_t content) {
    return name_of(patch) + ".contents[" + std::to_string(content) + "]";
}

std::string point(std::int32_t x, std::int32_t y) {
    return "texel (" + std::to_string(x) + ", " + std::to_string(y) + ")";
}

/// Every label names a patch, whose box encloses the texel; every patch has a texel.
Result<void> check_labels(const ExchangeAsset& asset, const AssetFiles& files) {
    std::vector<bool> seen(asset.patches.size());
    const std::int32_t mask = asset.tile_side - 1;
    for (std::int32_t y = 0, i = 0; y < asset.tile_side; ++y)
        for (std::int32_t x = 0; x < asset.tile_side; ++x, ++i) {
            const std::size_t label = asset.labels[static_cast<std::size_t>(i)];
            if (label >= asset.patches.size())
                return invalid(files.patches, point(x, y) + ": label " + std::to_string(label) +
                                                  ", but patches_info has only " +
                                                  std::to_string(asset.patches.size()) + " patches" + again);
            const Patch& patch = asset.patches[label];
            if (((x - patch.x) & mask) >= patch.width || ((y - patch.y) & mask) >= patch.height)
                return invalid(files.json, name_of(label) + ": its box does not hold " + point(x, y) +
                                               " of " + files.patches.filename().string() + again);
            seen[label] = true;
        }
    const auto unseen = std::find(seen.begin(), seen.end(), false);
    if (unseen != seen.end())
        return invalid(files.json, name_of(std::size_t(unseen - seen.begin())) + ": no texel of " +
                                       files.patches.filename().string() + " has this label" + again);
    return {};
}

/// A patch's contents show nothing outside its part of the patch map, so that patches never overlap.
Result<void> check_shapes_keep_to_labels(const ExchangeAsset& asset, const AssetFiles& files) {
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const BitMask whole = whole_shape(asset, p);
        for (std::size_t c = 0; c < asset.patches[p].contents.size(); ++c) {
            const BitMask& shape = asset.patches[p].contents[c].shape;
            for (std::size_t i = 0; i < shape.bytes.size(); ++i)
                if ((shape.bytes[i] & ~whole.bytes[i]) != 0)
                    return invalid(files.shapes, "the shape of " + name_of(p, c) + " of " +
                                                     files.json.filename().string() +
                                                     " leaves the patch's part of " +
                                                     files.patches.filename().string() + again);
        }
    }
    return {};
}

/// No patch of a set leaves the rhombus around its tile, texels by their centres, so that diagonal neighbours
/// never meet.
Result<void> check_rhombus(const ExchangeAsset& asset, const AssetFiles& files) {
    const std::int32_t side = asset.tile_side;
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const Patch& patch = asset.patches[p];
        if (patch.set == Set::none) continue;
        for (std::int32_t v = 0; v < patch.height; ++v)
            for (std::int32_t u = 0; u < patch.width; ++u) {
                const std::int32_t x = patch.x + u, y = patch.y + v;
                if (patch.contents[0].shape.at(u, v) &&
                    std::abs(2 * x + 1 - side) + std::abs(2 * y + 1 - side) >= 2 * side)
                    return invalid(files.json, name_of(p) + ": is in a set, and its " + point(x, y) +
                                                   " leaves the tile's rhombus; take it out of its set");
            }
    }
    return {};
}

/// A patch of set a and one of set b never overlap where their tiles are neighbours.
Result<void> check_sets(const ExchangeAsset& asset, const AssetFiles& files) {
    // Paint all of set a around one tile: 0 for none, else the number of a patch and 1
    const std::int32_t side = asset.tile_side, first = -side / 2, extent = 2 * side;
    std::vector<std::uint32_t> painted(std::size_t(extent) * std::size_t(extent));
    const auto for_each_texel = [&](Set set, auto&& call) {
        for (std::size_t p = 0; p < asset.patches.size(); ++p) {
            const Patch& patch = asset.patches[p];
            if (patch.set != set) continue;
            const BitMask& shape = patch.contents[0].shape;
            for (std::int32_t v = 0; v < patch.height; ++v)
                for (std::int32_t u = 0; u < patch.width; ++u)
                    if (shape.at(u, v)) call(p, patch.x + u - first, patch.y + v - first);
        }
    };
    for_each_texel(Set::a, [&](std::size_t p, std::int32_t x, std::int32_t y) {
        painted[std::size_t(y) * std::size_t(extent) + std::size_t(x)] = static_cast<std::uint32_t>(p + 1);
    });
    // Lay set b of each neighbour over it
    const std::array<std::array<std::int32_t, 2>, 4> neighbours{
        {{side, 0}, {-side, 0}, {0, side}, {0, -side}}};
    std::size_t a = 0, b = 0;
    for_each_texel(Set::b, [&](std::size_t p, std::int32_t x, std::int32_t y) {
        for (const auto& neighbour : neighbours) {
            const std::int32_t u = x + neighbour[0], v = y + neighbour[1];
            if (u < 0 || v < 0 || u >= extent || v >= extent) continue;
            const std::uint32_t other = painted[std::size_t(v) * std::size_t(extent) + std::size_t(u)];
            if (other != 0 && a == 0) a = other, b = p;
        }
    });
    if (a != 0)
        return invalid(files.json, name_of(b) + ": is in set b and overlaps " + name_of(a - 1) +
                                       " of set a on the neighbouring tile; take one of them out of its set");
    return {};
}

/// Patches that are shown together never overlap.
Result<void> check_groups(const ExchangeAsset& asset, const AssetFiles& files) {
    std::map<std::uint16_t, std::vector<std::size_t>> groups;
    for (std::size_t p = 0; p < asset.patches.size(); ++p)
        if (asset.patches[p].group != 0) groups[asset.patches[p].group].push_back(p);
    std::int64_t texels = 0;
    for (const auto& [number, members] : groups) {
        std::int32_t left = INT32_MAX, top = INT32_MAX, right = INT32_MIN, bottom = INT32_MIN;
        for (const std::size_t p : members) {
            const Patch& patch = asset.patches[p];
            left = std::min(left, patch.x);
            right = std::max(right, patch.x + patch.width);
            top = std::min(top, patch.y);
            bottom = std::max(bottom, patch.y + patch.height);
        }
        texels += std::int64_t{right - left} * (bottom - top);
        if (texels > max_sheet_texels)
            return invalid(files.json, "group " + std::to_string(number) + ": with it groups reach over " +
                                           std::to_string(texels >> 20) + " Mtexels; at most " +
                                           std::to_string(max_sheet_texels >> 20) + again);
        const std::int32_t width = right - left;
        std::vector<bool> taken(std::size_t(width) * std::size_t(bottom - top));
        for (const std::size_t p : members) {
            const Patch& patch = asset.patches[p];
            for (std::int32_t v = 0; v < patch.height; ++v)
                for (std::int32_t u = 0; u < patch.width; ++u) {
                    if (!patch.contents[0].shape.at(u, v)) continue;
                    const std::int32_t x = patch.x + u, y = patch.y + v;
                    const auto at = std::size_t(y - top) * std::size_t(width) + std::size_t(x - left);
                    if (taken[at])
                        return invalid(files.json, name_of(p) + ": overlaps another patch of group " +
                                                       std::to_string(number) + " at " + point(x, y) +
                                                       "; take one of them out of its group");
                    taken[at] = true;
                }
        }
    }
    return {};
}

/// Corner colours as people write them: "0102".
std::string digits(unsigned corners) {
    std::string text;
    for (unsigned i = 0; i < 4; ++i) text += static_cast<char>('0' + (corners >> 2 * i & 3));
    return text;
}

/// Every combination of corner colours has a tile that is shown; tile.png is that of 0000.
Result<void> check_corners(const ExchangeAsset& asset, const AssetFiles& files) {
    std::array<bool, 256> there{}, shown{};
    there[0] = shown[0] = true;
    unsigned colors = 2;
    for (const auto& content : asset.patches[0].contents) {
        there[content.corners] = true;
        shown[content.corners] |= content.standing != ExchangeAsset::Standing::dropped;
        for (unsigned i = 0; i < 4; ++i) colors = std::max(colors, (content.corners >> 2 * i & 3u) + 1);
    }
    for (unsigned corners = 0; corners < 256; ++corners) {
        bool made = true;
        for (unsigned i = 0; i < 4; ++i) made &= (corners >> 2 * i & 3u) < colors;
        if (!made || shown[corners]) continue;
        const std::string which = name_of(0) + ".contents: of " + std::to_string(colors) +
                                  " colours, the corners \"" + digits(corners) + "\" have no tile";
        if (there[corners])
            return invalid(files.json, which +
                                           " that is not dropped; each needs one, so keep it, and prepare "
                                           "with another --seed instead");
        return invalid(files.json, which + again);
    }
    return {};
}

/// Every content of a square tile shows all of it: nothing of another tile is seen through holes.
Result<void> check_full_squares(const ExchangeAsset& asset, const AssetFiles& files) {
    const BitMask whole = whole_shape(asset, 0);
    for (std::size_t c = 0; c < asset.patches[0].contents.size(); ++c)
        if (asset.patches[0].contents[c].shape != whole)
            return invalid(files.shapes, "the shape of " + name_of(0, c) + " of " +
                                             files.json.filename().string() +
                                             " has holes; a tile fills its square, so leave `shapes` unset");
    return {};
}

}  // namespace

Result<void> check_exchange_asset(const ExchangeAsset& asset, const AssetFiles& files) {
    const auto all = [&](auto... checks) -> Result<void> {
        Result<void> good;
        (void)((good = checks(asset, files)) && ...);
        return good;
    };
    switch (asset.method) {
        case ExchangeMethod::content_exchange:
            return all(check_labels, check_shapes_keep_to_labels);
        case ExchangeMethod::interchange:
            return all(check_rhombus, check_sets, check_groups);
        case ExchangeMethod::wang:
            break;
    }
    return all(check_corners, check_full_squares);
}

}  // namespace tessera
