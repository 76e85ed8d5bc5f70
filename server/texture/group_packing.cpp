#include "server/texture/group_packing.h"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

#include "server/texture/unit_outline.h"
#include "server/texture/unit_tree.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// More places of groups are not considered: all pairs of them are compared.
constexpr std::size_t most_places = 1024;
/// So long is looked for what covers more.
constexpr int most_steps = 4000;

}  // namespace

std::vector<ShownGroup> groups_of(const ExchangeAsset& asset, const Shapes& shapes) {
    std::map<std::uint16_t, std::vector<std::size_t>> members_of;
    for (std::size_t p = 0; p < asset.patches.size(); ++p)
        if (asset.patches[p].group != 0) members_of[asset.patches[p].group].push_back(p);
    const int tile_level = std::countr_zero(static_cast<std::uint32_t>(asset.tile_side));
    std::vector<ShownGroup> groups;
    for (const auto& [number, members] : members_of) {
        if (std::any_of(members.begin(), members.end(), [&](std::size_t p) {
                return asset.patches[p].contents[0].standing == ExchangeAsset::Standing::dropped;
            }))
            continue;
        std::int32_t left = INT32_MAX, top = INT32_MAX, right = INT32_MIN, bottom = INT32_MIN;
        for (const std::size_t p : members) {
            const ExchangeAsset::Patch& patch = asset.patches[p];
            left = std::min(left, patch.x);
            right = std::max(right, patch.x + patch.width);
            top = std::min(top, patch.y);
            bottom = std::max(bottom, patch.y + patch.height);
        }
        ShownGroup group{left, top, PackedPiece{right - left, bottom - top}, {}};
        for (const std::size_t p : members) {
            const ExchangeAsset::Patch& patch = asset.patches[p];
            group.piece.add(patch.contents[0].shape, patch.x - left, patch.y - top);
            group.shapes.push_back({static_cast<std::uint16_t>(shapes.first_of(p)),
                                    static_cast<std::int8_t>(patch.x >> tile_level),
                                    static_cast<std::int8_t>(patch.y >> tile_level)});
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

GroupPacking::GroupPacking(const std::vector<ShownGroup>& groups, std::int32_t tile_side,
                           const PackedGround& bare, std::int32_t ground_side)
    : how_often_(groups.size()) {
    for (const ShownGroup& group : groups) group_texels_.push_back(group.piece.texels);
    // Where the asset has them first of all, then moved by whole tiles
    constexpr std::int32_t farthest = 2 * UnitOutline::tiles;
    std::vector<std::pair<std::int32_t, std::int32_t>> moves;
    for (std::int32_t ty = -farthest; ty <= farthest; ++ty)
        for (std::int32_t tx = -farthest; tx <= farthest; ++tx) moves.emplace_back(ty, tx);
    std::stable_partition(moves.begin(), moves.end(), [](const auto& move) {
        return move == std::pair{0, 0};
    });
    const std::int32_t last = (UnitOutline::tiles + 1) * tile_side;
    for (const auto& [ty, tx] : moves)
        for (std::size_t g = 0; g < groups.size() && places_.size() < most_places; ++g) {
            const ShownGroup& group = groups[g];
            const Place place{g, group.x + tx * tile_side, group.y + ty * tile_side, tx, ty};
            if (place.x < 0 || place.y < 0 || place.x > last || place.y + group.piece.height > ground_side ||
                !fits(group.piece, place.x, place.y, bare))
                continue;
            places_.push_back(place);
            texels_.push_back(group.piece.texels);
        }
    meets_.resize(places_.size() * places_.size());
    for (std::size_t a = 0; a < places_.size(); ++a) {
        PackedGround ground = bare;
        lay(groups[places_[a].group].piece, places_[a].x, places_[a].y, ground);
        for (std::size_t b = 0; b < places_.size(); ++b)
            meets_[a * places_.size() + b] =
                !fits(groups[places_[b].group].piece, places_[b].x, places_[b].y, ground);
    }
}

struct GroupPacking::Search {
    std::vector<std::uint64_t> worths;       ///< Of all places.
    std::vector<std::size_t> taken, best{};  ///< Places.
    std::uint64_t most = 0;
    int steps = 0;
};

std::vector<GroupPacking::Place> GroupPacking::chosen(std::uint64_t seed, std::uint32_t type,
                                                      const std::vector<bool>& spent) const {
    constexpr std::uint64_t group_stream = stream("order of groups");
    const std::uint64_t most_often =
        how_often_.empty() ? 0 : *std::max_element(how_often_.begin(), how_often_.end());
    Search search;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        // Up to a quarter more by chance, and up to a quarter where it was shown seldom
        const std::uint64_t bits = hash(seed, group_stream, type, static_cast<std::int64_t>(i));
        const std::uint64_t seldom =
            1024 * (most_often - how_often_[places_[i].group]) / std::max<std::uint64_t>(most_often, 1);
        search.worths.push_back(static_cast<std::uint64_t>(texels_[i]) * (4096 + bits % 1024 + seldom));
        if (spent.empty() || !spent[places_[i].group]) order.push_back(i);
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::pair{search.worths[b], a} < std::pair{search.worths[a], b};
    });
    look(search, order, 0);
    std::vector<Place> places;
    for (const std::size_t i : search.best) places.push_back(places_[i]);
    return places;
}

void GroupPacking::add(const std::vector<Place>& places) {
    for (const Place& place : places) ++how_often_[place.group];
}

std::int64_t GroupPacking::covered(const std::vector<Place>& places) const {
    std::int64_t texels = 0;
    for (const Place& place : places) texels += group_texels_[place.group];
    return texels;
}

/// At most so many sets of groups of which no two share one, as long as groups fill a unit nearly as well as
/// at first.
std::vector<std::vector<GroupPacking::Place>> GroupPacking::apart(std::uint64_t seed, std::uint32_t number,
                                                                  std::size_t most) const {
    constexpr std::int64_t nearly = 80;  // of 100
    std::vector<std::vector<Place>> sets;
    std::vector<bool> spent(how_often_.size());
    while (sets.size() < most) {
        std::vector<Place> next = chosen(seed, number + static_cast<std::uint32_t>(sets.size()), spent);
        if (next.empty() || (!sets.empty() && covered(next) * 100 < covered(sets[0]) * nearly)) break;
        for (const Place& place : next) spent[place.group] = true;
        sets.push_back(std::move(next));
    }
    return sets;
}

GroupPacking::Classes GroupPacking::classes(std::uint64_t seed) {
    for (int heights = 2; heights > 0; --heights) {
        const std::size_t kept_apart = std::size_t{1} << (2 * heights);
        Classes classes;
        classes.apart = heights;
        const std::vector<std::uint64_t> before = how_often_;
        while (classes.shown.size() < UnitTree::classes) {
            const auto sets = apart(seed, static_cast<std::uint32_t>(classes.shown.size()), kept_apart);
            if (sets.size() < kept_apart) break;
            for (const std::vector<Place>& set : sets) {
                add(set);
                classes.shown.push_back(set);
            }
        }
        if (classes.shown.size() == UnitTree::classes) return classes;
        how_often_ = before;
    }
    return {};
}

/// Branch and bound: with and without each of what is left, the most worth first.
void GroupPacking::look(Search& search, const std::vector<std::size_t>& left, std::uint64_t worth) const {
    if (worth > search.most) {
        search.most = worth;
        search.best = search.taken;
    }
    std::uint64_t rest = 0;
    for (const std::size_t i : left) rest += search.worths[i];
    for (std::size_t k = 0; k < left.size(); ++k) {
        if (worth + rest <= search.most || ++search.steps > most_steps) return;
        const std::size_t i = left[k];
        rest -= search.worths[i];
        std::vector<std::size_t> apart;
        for (std::size_t j = k + 1; j < left.size(); ++j)
            if (!meets_[i * places_.size() + left[j]]) apart.push_back(left[j]);
        search.taken.push_back(i);
        look(search, apart, worth + search.worths[i]);
        search.taken.pop_back();
    }
}

}  // namespace tessera
