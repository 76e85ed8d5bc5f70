#include "server/texture/kolar_choice.h"

#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr double pi = 3.14159265358979323846;

/// By its series on [−π, π]; a whole number of radians, reduced first.
double sine(double x) {
    x -= std::floor(x / (2 * pi) + 0.5) * (2 * pi);
    double term = x, sum = x;
    for (int n = 2; n < 28; n += 2) {
        term *= -x * x / (n * (n + 1));
        sum += term;
    }
    return sum;
}

double hashed_fraction(std::uint64_t seed, std::uint64_t key, std::size_t patch) {
    return static_cast<double>(hash(seed, key, static_cast<std::int64_t>(patch), 0) >> 11) /
           9007199254740992.0;
}

/// Whether two shapes on one tile share a texel.
bool overlap(const ExchangeAsset::Patch& a, const ExchangeAsset::Patch& b) {
    const std::int32_t left = std::max(a.x, b.x), right = std::min(a.x + a.width, b.x + b.width);
    const std::int32_t top = std::max(a.y, b.y), bottom = std::min(a.y + a.height, b.y + b.height);
    for (std::int32_t y = top; y < bottom; ++y)
        for (std::int32_t x = left; x < right; ++x)
            if (a.contents[0].shape.at(x - a.x, y - a.y) && b.contents[0].shape.at(x - b.x, y - b.y))
                return true;
    return false;
}

/// Algorithm 2: of the active members, as long as two overlap, the first of those that overlap most others
/// goes.
void thin_out(std::vector<std::size_t>& active, const std::vector<std::vector<bool>>& overlaps) {
    for (;;) {
        std::size_t worst = 0, most = 0;
        for (std::size_t i = 0; i < active.size(); ++i) {
            std::size_t count = 0;
            for (const std::size_t other : active)
                count += other != active[i] && overlaps[active[i]][other] ? 1 : 0;
            if (count > most) {
                most = count;
                worst = i;
            }
        }
        if (most == 0) return;
        active.erase(active.begin() + static_cast<std::ptrdiff_t>(worst));
    }
}

}  // namespace

double kolar_draw(double alpha, double beta, std::int64_t a, std::int64_t b) {
    const auto x = static_cast<double>(a), y = static_cast<double>(b);
    const double across = alpha + x + sine(y + pi / 2), down = beta + y + sine(x);
    const double sum = across * across + down * down;
    return sum - std::floor(sum);
}

KolarChoice::KolarChoice(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed) {
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const std::uint32_t patch = shapes[s].patch;
        const ExchangeAsset::Set set = asset.patches[patch].set;
        if (set == ExchangeAsset::Set::none) continue;
        // Shapes are counted to the tile that their first texel meets: the tile's own, or one before it
        const auto before = [&](std::int32_t at) {
            return static_cast<std::int8_t>(std::floor(double(at) / asset.tile_side));
        };
        sets_[set == ExchangeAsset::Set::b ? 1 : 0].members.push_back(
            {{static_cast<std::uint16_t>(s), before(asset.patches[patch].x), before(asset.patches[patch].y)},
             hashed_fraction(seed, stream("kolar alpha"), patch),
             hashed_fraction(seed, stream("kolar beta"), patch)});
    }
    for (Set& set : sets_) {
        const auto patch_of = [&](const Member& member) -> const ExchangeAsset::Patch& {
            return asset.patches[shapes[member.shown.shape].patch];
        };
        for (const Member& a : set.members) {
            std::vector<bool>& row = set.overlaps.emplace_back();
            for (const Member& b : set.members) row.push_back(overlap(patch_of(a), patch_of(b)));
        }
    }
}

std::vector<Shown> KolarChoice::shown_by(std::int64_t tile_x, std::int64_t tile_y) const {
    const Set& set = sets_[(tile_x + tile_y) & 1];
    // The paper's η: ten patches are active on average
    const double threshold = 10.0 / static_cast<double>(set.members.size());
    std::vector<std::size_t> active;
    for (std::size_t i = 0; i < set.members.size(); ++i)
        if (kolar_draw(set.members[i].alpha, set.members[i].beta, tile_x, tile_y) < threshold)
            active.push_back(i);
    thin_out(active, set.overlaps);
    std::vector<Shown> shown;
    for (const std::size_t i : active) shown.push_back(set.members[i].shown);
    return shown;
}

}  // namespace tessera
