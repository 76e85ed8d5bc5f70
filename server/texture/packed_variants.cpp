#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "server/texture/group_packing.h"
#include "server/texture/packed_ground.h"
#include "server/texture/unit_choice.h"
#include "server/texture/unit_outline.h"
#include "server/texture/unit_tree.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// A shape that is shown alone.
struct Piece {
    std::uint16_t shape = 0;
    std::int32_t x = 0, y = 0;  ///< On the tile, 0 to side − 1.
    PackedPiece texels;
};

std::vector<Piece> pieces_of(const ExchangeAsset& asset, const Shapes& shapes) {
    std::vector<Piece> pieces;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const ExchangeAsset::Patch& patch = asset.patches[shapes[s].patch];
        if (patch.group != 0) continue;
        const BitMask& mask = patch.contents[shapes[s].content].shape;
        pieces.push_back({static_cast<std::uint16_t>(s), patch.x & (asset.tile_side - 1),
                          patch.y & (asset.tile_side - 1), PackedPiece{mask.width, mask.height}});
        pieces.back().texels.add(mask, 0, 0);
    }
    return pieces;
}

/// What the places of the tile have shown so far, over all units that are packed: each one's sum of how far
/// it was from the exemplar's mean lightness. Where nothing repeats, these sums stay small; where the tile
/// shows too often, or one patch, or patches that are all darker than the mean, they grow, and patches that
/// bring them back are worth more.
class Evenness {
  public:
    Evenness(const ExchangeAsset& asset, const Shapes& shapes)
        : asset_{asset},
          shapes_{shapes},
          tile_{lightness_of(asset.tile)},
          exemplar_{lightness_of(asset.exemplar)},
          sums_(tile_.size()) {
        std::int64_t sum = 0, squares = 0;
        for (const std::int32_t value : exemplar_) sum += value;
        const auto mean = static_cast<std::int32_t>(sum / std::ssize(exemplar_));
        for (std::int32_t& value : tile_) value -= mean;
        for (std::int32_t& value : exemplar_) value -= mean;
        for (const std::int32_t value : tile_) squares += std::int64_t{value} * value;
        variance_ = std::max<std::int64_t>(1, squares / std::ssize(tile_));
        for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
            find_runs(shape);
            ends_.push_back(runs_.size());
        }
    }

    /// One for each shape: its texels, and more if it brings the sums closer to 0, at least one.
    std::vector<std::uint64_t> worths(const std::vector<Piece>& pieces) const {
        // Such a share of all deviation that a patch takes away doubles its worth
        constexpr std::int64_t doubled = 16;
        std::vector<std::uint64_t> worths;
        for (const Piece& piece : pieces) {
            std::int64_t gain = 0;
            for (const Run& run : runs_of(piece.shape))
                for (std::uint32_t i = 0; i < run.texels; ++i)
                    gain -=
                        std::int64_t{sums_[run.place + i]} * (exemplar_[run.from + i] - tile_[run.place + i]);
            const std::int64_t texels =
                piece.texels.texels + doubled * gain / (variance_ * std::max<std::int64_t>(occurrences_, 1));
            worths.push_back(
                static_cast<std::uint64_t>(std::max<std::int64_t>(texels, 1 + piece.texels.texels / 64)));
        }
        return worths;
    }

    /// A unit of so many tiles shows these.
    void add(std::span<const Shown> list, std::int32_t tiles) {
        occurrences_ += tiles;
        for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += tiles * tile_[i];
        for (const Shown& shown : list)
            for (const Run& run : runs_of(shown.shape)) add(run);
    }

  private:
    static std::vector<std::int32_t> lightness_of(const Rgb8Image& image) {
        std::vector<std::int32_t> out;
        out.reserve(image.bytes.size() / 3);
        for (std::size_t i = 0; i + 2 < image.bytes.size(); i += 3)
            out.push_back((77 * image.bytes[i] + 150 * image.bytes[i + 1] + 29 * image.bytes[i + 2]) >> 8);
        return out;
    }

    /// Texels of a shape that follow each other on the tile and in the exemplar.
    struct Run {
        std::uint32_t place = 0, from = 0;  ///< The first one's number on the tile and in the exemplar.
        std::uint32_t texels = 0;
    };

    std::span<const Run> runs_of(std::size_t shape) const {
        const std::size_t begin = shape == 0 ? 0 : ends_[shape - 1];
        return {runs_.data() + begin, ends_[shape] - begin};
    }

    /// How much lighter the shape's texels are than the tile.
    void add(const Run& run) {
        std::int32_t* sum = sums_.data() + run.place;
        const std::int32_t* tile = tile_.data() + run.place;
        const std::int32_t* light = exemplar_.data() + run.from;
        for (std::uint32_t i = 0; i < run.texels; ++i) sum[i] += light[i] - tile[i];
    }

    void find_runs(std::size_t shape) {
        const ExchangeAsset::Patch& patch = asset_.patches[shapes_[shape].patch];
        const auto& content = patch.contents[shapes_[shape].content];
        const std::int32_t side = asset_.tile_side, wrap = side - 1;
        for (std::int32_t y = 0; y < patch.height; ++y) {
            const std::int32_t row = ((patch.y + y) & wrap) * side;
            const std::int32_t line = (content.at.y + y) * asset_.exemplar.width + content.at.x;
            for (std::int32_t x = 0; x < patch.width;) {
                if (!content.shape.at(x, y)) {
                    ++x;
                    continue;
                }
                const std::int32_t first = x, column = (patch.x + x) & wrap;
                const std::int32_t most = std::min(patch.width, first + side - column);
                while (x < most && content.shape.at(x, y)) ++x;
                runs_.push_back({static_cast<std::uint32_t>(row + column),
                                 static_cast<std::uint32_t>(line + first),
                                 static_cast<std::uint32_t>(x - first)});
            }
        }
    }

    const ExchangeAsset& asset_;
    const Shapes& shapes_;
    std::vector<std::int32_t> tile_, exemplar_;  ///< Lightness less the exemplar's mean, in codes.
    std::vector<std::int32_t> sums_;
    std::vector<Run> runs_;          ///< Shape by shape, …
    std::vector<std::size_t> ends_;  ///< … up to here.
    std::int64_t variance_ = 1, occurrences_ = 0;
};

/// Sorts numbers by the bits from `from` on; those alike there stay in their order. `scratch`: as long.
void sort_by_bits(int from, std::vector<std::uint64_t>& numbers, std::vector<std::uint64_t>& scratch) {
    constexpr int digit_bits = 11;
    constexpr std::uint64_t digits = std::uint64_t{1} << digit_bits;
    std::uint64_t used = 0;
    for (const std::uint64_t number : numbers) used |= number;
    for (int at = from; at < 64 && used >> at != 0; at += digit_bits) {
        std::array<std::size_t, digits> place{};
        for (const std::uint64_t number : numbers) ++place[number >> at & (digits - 1)];
        std::size_t sum = 0;
        for (std::size_t& count : place) sum += std::exchange(count, sum);
        for (const std::uint64_t number : numbers) scratch[place[number >> at & (digits - 1)]++] = number;
        numbers.swap(scratch);
    }
}

}  // namespace

/// Kolář lets every tile draw its patches, and keeps what one tile shows off what its neighbours may show by
/// two sets and a rhombus (section 4.1); whatever no patch may cross, the corners first of all, then shows in
/// every tile. Here a unit of 4 × 4 tiles is decided at once, where any patch may lie on any tile, whatever
/// its set; nothing crosses the unit's outline, and that lies on other places of the tile in every tile it
/// crosses.
///
/// A list is maximal: patches are tried in a random order, those first that are large and even out what the
/// lists before it show, and shown if they overlap none that is shown already. The paper draws few
/// (η = 10 / |patches|) and thins them out (algorithm 2), which leaves more of the repeating tile in sight.
/// Groups are laid before single patches: where several fill a unit, little is left of the tile.
Variants packed_variants(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed,
                         std::uint32_t types) {
    constexpr std::int32_t unit_tiles = UnitOutline::tiles;
    constexpr std::uint64_t order_stream = stream("order of patches");
    const std::int32_t tile = asset.tile_side, side = unit_tiles * tile;
    const std::vector<Piece> pieces = pieces_of(asset, shapes);
    const std::vector<ShownGroup> groups = groups_of(asset, shapes);

    // Everything outside the outline is taken
    const UnitOutline outline = groups.empty()
                                    ? UnitOutline{seed, tile, shapes.radius()}
                                    : UnitOutline{UnitOutline::seed_of_groups, tile, asset.blend_texels / 2};
    std::int32_t reach = 0;
    for (const ShownGroup& group : groups)
        reach = std::max({reach, group.piece.words * 64, group.piece.height});
    for (const Piece& piece : pieces) reach = std::max({reach, piece.texels.words * 64, piece.texels.height});
    const std::int32_t ground_side = side + tile + reach;
    PackedGround bare{ground_side, ground_side};
    for (std::int32_t y = 0; y < ground_side; ++y)
        for (std::int32_t x = 0; x < ground_side; ++x)
            if (x >= 2 * side || y >= 2 * side || !outline.holds(x, y)) bare.take(x, y);

    // Every place where a patch fits if it is alone
    struct Place {
        std::uint32_t piece = 0;
        std::int8_t tile_x = 0, tile_y = 0;
    };
    std::vector<Place> places;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        for (std::int8_t ty = 0; ty <= unit_tiles; ++ty)
            for (std::int8_t tx = 0; tx <= unit_tiles; ++tx)
                if (fits(pieces[i].texels, pieces[i].x + tx * tile, pieces[i].y + ty * tile, bare))
                    places.push_back({static_cast<std::uint32_t>(i), tx, ty});

    GroupPacking packing{groups, tile, bare, ground_side};
    const GroupPacking::Classes classes = packing.classes(seed);
    std::vector<std::vector<GroupPacking::Place>> grouped(types);
    const int place_bits = static_cast<int>(std::bit_width(places.size()));
    const std::uint64_t most_worth = ~std::uint64_t{0} >> place_bits;

    std::vector<std::vector<Shown>> lists(types);
    const auto pack = [&](std::uint32_t type, const std::vector<std::uint64_t>& worths) {
        // Large worths first, and then small places: as one number, where there is room for both
        std::vector<std::uint64_t> order(places.size()), scratch(places.size());
        std::uint64_t largest = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            // Up to twice its worth
            const std::uint64_t bits = hash(seed, order_stream, type, static_cast<std::int64_t>(i));
            const std::uint64_t worth =
                std::min(worths[places[i].piece] * (65536 + bits % 65536), most_worth);
            order[i] = worth;
            largest = std::max(largest, worth);
        }
        for (std::size_t i = 0; i < places.size(); ++i) order[i] = (largest - order[i]) << place_bits | i;
        sort_by_bits(place_bits, order, scratch);
        PackedGround ground = bare;
        grouped[type] =
            classes.apart > 0 ? classes.shown[type % UnitTree::classes] : packing.chosen(seed, type);
        for (const GroupPacking::Place& place : grouped[type]) {
            lay(groups[place.group].piece, place.x, place.y, ground);
            for (Shown shown : groups[place.group].shapes) {
                shown.tile_x = static_cast<std::int8_t>(shown.tile_x + place.tile_x);
                shown.tile_y = static_cast<std::int8_t>(shown.tile_y + place.tile_y);
                lists[type].push_back(shown);
            }
        }
        for (const std::uint64_t next : order) {
            const Place& place = places[next & ((std::uint64_t{1} << place_bits) - 1)];
            const Piece& piece = pieces[place.piece];
            const std::int32_t x = piece.x + place.tile_x * tile, y = piece.y + place.tile_y * tile;
            if (!fits(piece.texels, x, y, ground)) continue;
            lay(piece.texels, x, y, ground);
            lists[type].push_back({piece.shape, place.tile_x, place.tile_y});
        }
    };

    // So many at once know the same of those before them, whatever the number of threads
    constexpr std::uint32_t batch = 16;
    Evenness evenness{asset, shapes};
    for (std::uint32_t first = 0; first < types; first += batch) {
        const std::uint32_t end = std::min(types, first + batch);
        const std::vector<std::uint64_t> worths = evenness.worths(pieces);
        std::atomic<std::uint32_t> next{first};
        const auto run = [&] {
            for (std::uint32_t type = next++; type < end; type = next++) pack(type, worths);
        };
        {
            std::vector<std::jthread> helpers;
            for (unsigned i = 1; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
                helpers.emplace_back(run);
            run();
        }
        for (std::uint32_t type = first; type < end; ++type) {
            evenness.add(lists[type], unit_tiles * unit_tiles);
            packing.add(grouped[type]);
        }
    }

    Variants variants;
    variants.unit_tiles = unit_tiles;
    variants.apart = classes.apart;
    for (const auto& list : lists) variants.add(list);
    return variants;
}

}  // namespace tessera
