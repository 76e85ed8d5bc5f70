#include "server/prepare/interchange_groups.h"

#include <algorithm>
#include <atomic>

#include "server/prepare/parallel.h"
#include "server/prepare/seam.h"
#include "server/texture/unit_outline.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::uint64_t layer_stream = stream("group layer"), group_stream = stream("group");

/// Each layer divides a unit into so many parts each way.
constexpr std::int32_t parts_a_side = 2;

/// Four groups a part: two texels of the plane some units apart show the same one about once in 24 times.
/// More would take too long.
constexpr std::int64_t most_layers = 6;
/// Of groups all together: it bounds time and memory where tiles are large.
constexpr std::int64_t most_texels = std::int64_t{1} << 25;

/// Smaller patches than this fill nothing.
constexpr std::int32_t least_side = 16;

/// A curve through hashed heights, straight in between, over a length.
std::vector<std::int32_t> wander(std::uint64_t bits, std::int32_t length, std::int32_t step,
                                 std::int32_t first, std::int32_t range) {
    const auto height = [&](std::int32_t knot) {
        return first + static_cast<std::int32_t>(uniform_below(hash(bits, layer_stream, knot, 2),
                                                               static_cast<std::uint32_t>(range)));
    };
    std::vector<std::int32_t> out;
    for (std::int32_t i = 0; i < length; ++i) {
        const std::int32_t a = height(i / step), b = height(i / step + 1);
        out.push_back(a + (b - a) * (i % step) / step);
    }
    return out;
}

/// Regions of one layer: the unit divided by curves, `count` each way.
std::vector<PatchRegion> regions_of(const UnitOutline& outline, std::int32_t tile_side, std::int32_t count,
                                    std::uint64_t bits) {
    const std::int32_t side = outline.side(), extent = 2 * side, part = side / count;
    std::vector<std::vector<std::int32_t>> down, right;
    for (std::int32_t i = 0; i + 1 < count; ++i) {
        // The unit lies half a tile off, since its outline wanders so far
        const std::int32_t middle = tile_side / 4 + (i + 1) * part;
        const std::int32_t range = part / 2, first = middle - range / 2;
        const std::uint64_t here = hash(bits, layer_stream, i, 0), there = hash(bits, layer_stream, i, 1);
        down.push_back(wander(here, extent, tile_side / 4, first, range));
        right.push_back(wander(there, extent, tile_side / 4, first, range));
    }
    struct Box {
        std::int32_t left = INT32_MAX, top = INT32_MAX, right = 0, bottom = 0;
    };
    std::vector<Box> boxes(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
    std::vector<std::int16_t> labels(static_cast<std::size_t>(extent) * static_cast<std::size_t>(extent), -1);
    for (std::int32_t y = 0; y < extent; ++y)
        for (std::int32_t x = 0; x < extent; ++x) {
            if (!outline.holds(x, y)) continue;
            std::int32_t column = 0, row = 0;
            for (const auto& curve : right) column += x >= curve[static_cast<std::size_t>(y)];
            for (const auto& curve : down) row += y >= curve[static_cast<std::size_t>(x)];
            const std::int32_t label = row * count + column;
            labels[static_cast<std::size_t>(y) * static_cast<std::size_t>(extent) +
                   static_cast<std::size_t>(x)] = static_cast<std::int16_t>(label);
            Box& box = boxes[static_cast<std::size_t>(label)];
            box.left = std::min(box.left, x), box.right = std::max(box.right, x + 1);
            box.top = std::min(box.top, y), box.bottom = std::max(box.bottom, y + 1);
        }
    std::vector<PatchRegion> regions;
    for (std::size_t b = 0; b < boxes.size(); ++b) {
        const Box& box = boxes[b];
        if (box.right == 0) continue;
        PatchRegion region;
        region.side = std::max(box.right - box.left, box.bottom - box.top) + 2;
        region.x = box.left - 1, region.y = box.top - 1;
        region.inside.resize(static_cast<std::size_t>(region.side) * static_cast<std::size_t>(region.side));
        for (std::int32_t y = box.top; y < box.bottom; ++y)
            for (std::int32_t x = box.left; x < box.right; ++x)
                region.inside[static_cast<std::size_t>((y - region.y) * region.side + x - region.x)] =
                    labels[static_cast<std::size_t>(y) * static_cast<std::size_t>(extent) +
                           static_cast<std::size_t>(x)] == static_cast<std::int16_t>(b);
        regions.push_back(std::move(region));
    }
    return regions;
}

/// Few and large patches leave features whole; but the photograph must have other places for them.
std::int32_t largest_side(const PerceptualImage& photo, std::int32_t tile_side, std::int32_t margin) {
    const std::int32_t room = std::min(photo.width, photo.height) - 2 * margin;
    return std::min(tile_side / 2, room * 2 / 5);
}

struct Layers {
    std::int64_t count = 0, groups_a_part = 0;
};

/// As many as an asset of at most four times the photograph's texels has room for, beside its images and the
/// patches that are shown alone.
Layers layers_for(const PerceptualImage& photo, std::int32_t tile_side, std::int32_t largest,
                  std::int32_t alone) {
    constexpr std::int64_t bytes_of_patch = 200;  // in asset.json
    constexpr std::int64_t texels_a_byte = 30;    // of shapes, packed
    const std::int64_t tile = std::int64_t{tile_side} * tile_side;
    const std::int64_t unit = UnitOutline::tiles * UnitOutline::tiles * tile;
    const std::int64_t patches = unit * 5 / 2 / (std::int64_t{largest} * largest);
    const std::int64_t bytes = patches * bytes_of_patch + unit / texels_a_byte;  // of a group for each part
    const std::int64_t texels = std::int64_t{photo.width} * photo.height;
    const std::int64_t images = (texels + tile) * 3 * 3 / 4;  // as PNG files
    const std::int64_t room = 4 * 3 * texels - images - alone * bytes_of_patch;
    Layers most{std::min<std::int64_t>(1, most_texels / (2 * unit)), 2};
    for (const std::int64_t groups : {2, 4}) {
        const std::int64_t count =
            std::min({most_layers, most_texels / (groups * unit), room * 7 / 8 / (groups * bytes)});
        if (count > 0 && count * groups >= most.count * most.groups_a_part) most = {count, groups};
    }
    return most;
}

bool is_among(const std::vector<InterchangeGroup>& groups, const InterchangeGroup& group) {
    const auto same = [](const InterchangePatch& a, const InterchangePatch& b) {
        return a.x == b.x && a.y == b.y && a.at == b.at && a.shape == b.shape;
    };
    return std::any_of(groups.begin(), groups.end(), [&](const InterchangeGroup& other) {
        return std::equal(group.patches.begin(), group.patches.end(), other.patches.begin(),
                          other.patches.end(), same);
    });
}

}  // namespace

std::vector<InterchangeGroup> find_groups(const PerceptualImage& photo, const QuiltedTile& tile,
                                          const GroupSearch& search, Progress& progress) {
    const std::int32_t margin = search.blend_texels / 2;
    const std::int32_t largest = largest_side(photo, tile.side, margin);
    if (largest < least_side) return {};
    const GroupSources sources{photo, tile, mean_gradient(photo), margin, largest};
    const UnitOutline outline{UnitOutline::seed_of_groups, tile.side, margin};
    const Layers layers = layers_for(photo, tile.side, largest, search.alone);
    const auto groups_a_part = static_cast<std::size_t>(layers.groups_a_part);

    std::vector<PatchRegion> regions;
    for (std::int64_t layer = 0; layer < layers.count; ++layer)
        for (PatchRegion& region :
             regions_of(outline, tile.side, parts_a_side, hash(search.seed, layer_stream, layer, 0)))
            regions.push_back(std::move(region));
    std::vector<InterchangeGroup> found(regions.size() * groups_a_part);
    std::atomic<std::size_t> done{0};
    for_each_index(found.size(), search.threads, [&](std::size_t i) {
        const PatchRegion& region = regions[i / groups_a_part];
        // What a person dropped is made anew; what that was replaced by may be dropped, too
        for (std::int64_t attempt = 0; !progress.stop().stop_requested(); ++attempt) {
            found[i] = fill_region(sources, region,
                                   hash(search.seed, group_stream, static_cast<std::int64_t>(i), attempt));
            if (!is_among(search.unwanted, found[i])) break;
        }
        progress.advance("groups", static_cast<double>(++done) / static_cast<double>(found.size()));
    });
    if (progress.stop().stop_requested()) return {};
    std::erase_if(found, [&](const InterchangeGroup& group) {
        return group.patches.empty() || is_among(search.given, group);
    });
    return found;
}

}  // namespace tessera
