#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "server/texture/unit_choice.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// A unit's outline. A texel (x, y) of the plane belongs to the unit whose number is
/// (⌊(x − right(y)) / side⌋, ⌊(y − down(x)) / side⌋): units are translates of one another, whatever the two
/// curves are, and cover the plane. Curves wander over half a tile, so that what lies along them, where no
/// patch ever crosses, falls on other places of the tile in every tile.
class Outline {
  public:
    /// `side`: of the unit; `tile`: of its tiles; values from `least` on, so that blended shapes begin
    /// inside.
    Outline(std::uint64_t seed, std::int32_t side, std::int32_t tile, std::int32_t least)
        : right_{curve(seed, 0, side, tile, least)}, down_{curve(seed, 1, side, tile, least)}, side_{side} {}

    /// 0 ≤ x, y < 2·side.
    bool holds(std::int32_t x, std::int32_t y) const noexcept {
        const std::int32_t u = x - right_[std::size_t(y % side_)], v = y - down_[std::size_t(x % side_)];
        return u >= 0 && u < side_ && v >= 0 && v < side_;
    }

  private:
    /// A periodic curve through hashed heights, four to a tile, straight in between.
    static std::vector<std::int32_t> curve(std::uint64_t seed, std::uint64_t axis, std::int32_t side,
                                           std::int32_t tile, std::int32_t least) {
        const std::int32_t step = std::max(1, tile / 4);
        const std::int32_t knots = side / step;
        const auto height = [&](std::int32_t knot) {
            return least + static_cast<std::int32_t>(
                               uniform_below(hash(seed, stream("unit outline", axis), knot % knots, 0),
                                             static_cast<std::uint32_t>(tile / 2)));
        };
        std::vector<std::int32_t> out;
        for (std::int32_t i = 0; i < side; ++i) {
            const std::int32_t a = height(i / step), b = height(i / step + 1);
            out.push_back(a + (b - a) * (i % step) / step);
        }
        return out;
    }

    std::vector<std::int32_t> right_, down_;
    std::int32_t side_;
};

/// Which texels of a unit and of what hangs over it are taken: rows of 64-bit words, one word more than
/// needed.
class Ground {
  public:
    Ground(std::int32_t width, std::int32_t height)
        : words_(std::size_t(width) / 64 + 2), bits_(words_ * std::size_t(height)) {}

    void take(std::int32_t x, std::int32_t y) noexcept {
        bits_[std::size_t(y) * words_ + std::size_t(x) / 64] |= std::uint64_t{1} << x % 64;
    }
    std::uint64_t* row(std::int32_t y) noexcept { return bits_.data() + std::size_t(y) * words_; }

  private:
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

/// A shape's texels without blending, ready to be laid on the ground.
struct Piece {
    std::uint16_t shape = 0;
    std::int32_t x = 0, y = 0;  ///< On the tile, 0 to side − 1.
    std::int32_t words = 0;     ///< A row's.
    std::int32_t height = 0;
    std::vector<std::uint64_t> bits;
    std::int32_t texels = 0;
};

std::vector<Piece> pieces_of(const ExchangeAsset& asset, const Shapes& shapes) {
    std::vector<Piece> pieces;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const ExchangeAsset::Patch& patch = asset.patches[shapes[s].patch];
        const BitMask& mask = patch.contents[shapes[s].content].shape;
        Piece piece;
        piece.shape = static_cast<std::uint16_t>(s);
        piece.x = patch.x & (asset.tile_side - 1);
        piece.y = patch.y & (asset.tile_side - 1);
        piece.words = (mask.width + 63) / 64;
        piece.height = mask.height;
        piece.bits.resize(std::size_t(piece.words) * std::size_t(mask.height));
        for (std::int32_t y = 0; y < mask.height; ++y)
            for (std::int32_t x = 0; x < mask.width; ++x)
                if (mask.at(x, y)) {
                    piece.bits[std::size_t(y * piece.words + x / 64)] |= std::uint64_t{1} << x % 64;
                    ++piece.texels;
                }
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

/// Whether the piece lies on free ground only. Begins with the middle, where it is widest.
bool fits(const Piece& piece, std::int32_t x, std::int32_t y, Ground& ground) {
    const int shift = x % 64;
    for (std::int32_t i = 0, row = piece.height / 2; i < piece.height; ++i, ++row) {
        if (row == piece.height) row = 0;
        const std::uint64_t* from = piece.bits.data() + std::ptrdiff_t{row} * piece.words;
        const std::uint64_t* to = ground.row(y + row) + x / 64;
        for (std::int32_t w = 0; w < piece.words; ++w) {
            if ((from[w] << shift & to[w]) != 0) return false;
            if (shift > 0 && (from[w] >> (64 - shift) & to[w + 1]) != 0) return false;
        }
    }
    return true;
}

void lay(const Piece& piece, std::int32_t x, std::int32_t y, Ground& ground) {
    const int shift = x % 64;
    for (std::int32_t row = 0; row < piece.height; ++row) {
        const std::uint64_t* from = piece.bits.data() + std::ptrdiff_t{row} * piece.words;
        std::uint64_t* to = ground.row(y + row) + x / 64;
        for (std::int32_t w = 0; w < piece.words; ++w) {
            to[w] |= from[w] << shift;
            if (shift > 0) to[w + 1] |= from[w] >> (64 - shift);
        }
    }
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
        std::size_t texels = 0;
        for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
            const ExchangeAsset::Patch& patch = asset.patches[shapes[shape].patch];
            texels += std::size_t(patch.width) * std::size_t(patch.height);
        }
        if (texels > most_listed) return;
        for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
            find_texels(shape, [&](std::size_t place, std::int32_t step) {
                texels_.push_back({static_cast<std::uint32_t>(place), step});
            });
            ends_.push_back(texels_.size());
        }
    }

    /// One for each shape: its texels, and more if it brings the sums closer to 0, at least one.
    std::vector<std::uint64_t> worths(const std::vector<Piece>& pieces) const {
        // Such a share of all deviation that a patch takes away doubles its worth
        constexpr std::int64_t doubled = 16;
        std::vector<std::uint64_t> worths;
        for (const Piece& piece : pieces) {
            std::int64_t gain = 0;
            for_each_texel(piece.shape, [&](std::size_t place, std::int32_t step) {
                gain -= std::int64_t{sums_[place]} * step;
            });
            const std::int64_t texels =
                piece.texels + doubled * gain / (variance_ * std::max<std::int64_t>(occurrences_, 1));
            worths.push_back(
                static_cast<std::uint64_t>(std::max<std::int64_t>(texels, 1 + piece.texels / 64)));
        }
        return worths;
    }

    /// A unit of so many tiles shows these.
    void add(std::span<const Shown> list, std::int32_t tiles) {
        occurrences_ += tiles;
        for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += tiles * tile_[i];
        for (const Shown& shown : list)
            for_each_texel(shown.shape, [&](std::size_t place, std::int32_t step) { sums_[place] += step; });
    }

  private:
    static std::vector<std::int32_t> lightness_of(const Rgb8Image& image) {
        std::vector<std::int32_t> out;
        out.reserve(image.bytes.size() / 3);
        for (std::size_t i = 0; i + 2 < image.bytes.size(); i += 3)
            out.push_back((77 * image.bytes[i] + 150 * image.bytes[i + 1] + 29 * image.bytes[i + 2]) >> 8);
        return out;
    }

    /// A place on the tile, and how much lighter a shape's texel is there. They are looked at once for each
    /// batch of units: listed, unless the patches are very large.
    struct Texel {
        std::uint32_t place = 0;
        std::int32_t step = 0;
    };
    static constexpr std::size_t most_listed = std::size_t{1} << 24;

    template <class Call>
    void for_each_texel(std::size_t shape, Call&& call) const {
        if (ends_.empty()) return find_texels(shape, call);
        for (std::size_t i = shape == 0 ? 0 : ends_[shape - 1]; i < ends_[shape]; ++i)
            call(texels_[i].place, texels_[i].step);
    }
    template <class Call>
    void find_texels(std::size_t shape, Call&& call) const {
        const ExchangeAsset::Patch& patch = asset_.patches[shapes_[shape].patch];
        const auto& content = patch.contents[shapes_[shape].content];
        const std::int32_t wrap = asset_.tile_side - 1;
        for (std::int32_t y = 0; y < patch.height; ++y) {
            const std::size_t row = std::size_t((patch.y + y) & wrap) * std::size_t(asset_.tile_side);
            const std::int32_t* light =
                exemplar_.data() + std::ptrdiff_t{content.at.y + y} * asset_.exemplar.width + content.at.x;
            for (std::int32_t x = 0; x < patch.width; ++x) {
                if (!content.shape.at(x, y)) continue;
                const std::size_t place = row + std::size_t((patch.x + x) & wrap);
                call(place, light[x] - tile_[place]);
            }
        }
    }

    const ExchangeAsset& asset_;
    const Shapes& shapes_;
    std::vector<std::int32_t> tile_, exemplar_;  ///< Lightness less the exemplar's mean, in codes.
    std::vector<std::int32_t> sums_;
    std::vector<Texel> texels_;      ///< Shape by shape, …
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
Variants packed_variants(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed,
                         std::uint32_t types) {
    constexpr std::int32_t unit_tiles = 4;
    constexpr std::uint64_t order_stream = stream("order of patches");
    const std::int32_t tile = asset.tile_side, side = unit_tiles * tile;
    const std::vector<Piece> pieces = pieces_of(asset, shapes);

    // Everything outside the outline is taken
    const Outline outline{seed, side, tile, shapes.radius()};
    std::int32_t reach = 0;
    for (const Piece& piece : pieces) reach = std::max({reach, piece.words * 64, piece.height});
    const std::int32_t ground_side = side + tile + reach;
    Ground bare{ground_side, ground_side};
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
                if (fits(pieces[i], pieces[i].x + tx * tile, pieces[i].y + ty * tile, bare))
                    places.push_back({static_cast<std::uint32_t>(i), tx, ty});

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
        Ground ground = bare;
        for (const std::uint64_t next : order) {
            const Place& place = places[next & ((std::uint64_t{1} << place_bits) - 1)];
            const Piece& piece = pieces[place.piece];
            const std::int32_t x = piece.x + place.tile_x * tile, y = piece.y + place.tile_y * tile;
            if (!fits(piece, x, y, ground)) continue;
            lay(piece, x, y, ground);
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
        for (std::uint32_t type = first; type < end; ++type)
            evenness.add(lists[type], unit_tiles * unit_tiles);
    }

    Variants variants;
    variants.unit_tiles = unit_tiles;
    for (const auto& list : lists) variants.add(list);
    return variants;
}

}  // namespace tessera
