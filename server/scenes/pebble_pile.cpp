#include "server/scenes/pebble_pile.h"

#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"

namespace tessera {
namespace {

/// One bed of stones, the largest placed first. Radii are in texels of the finished picture.
struct Bed {
    double largest, smallest;
    double shrink;   ///< From one size to the next.
    double spacing;  ///< 1: neighbours touch; less: they overlap.
    double tries;    ///< Throws per size, for each place that a stone of that size could take.
    double sink;     ///< How deep a stone settles into what is below, in its half heights.
};

constexpr Bed beds[] = {
    {5.0, 1.8, 0.80, 0.80, 1.6, 0.2},     // gravel that covers most of the sand
    {15.0, 4.0, 0.82, 0.86, 1.3, 0.15},   // what shows in the gaps
    {27.0, 5.0, 0.87, 0.92, 0.60, 0.35},  // what one sees
};

double wrapped(double difference, double side) noexcept {
    if (difference > 0.5 * side) return difference - side;
    return difference < -0.5 * side ? difference + side : difference;
}

/// Stones of one bed keep apart; a coarse grid finds the neighbours of a place.
class Bedding {
  public:
    Bedding(std::int32_t side, double cell)
        : side_{static_cast<double>(side)},
          cells_{std::max(1, static_cast<std::int32_t>(side_ / cell))},
          grid_(std::size_t(cells_) * std::size_t(cells_)) {}

    bool fits(const Pebble& pebble, double spacing) const {
        const std::int32_t cx = cell_of(pebble.x), cy = cell_of(pebble.y);
        const std::int32_t around = std::min(1, (cells_ - 1) / 2);
        // Fewer than three cells a side: all are neighbours
        const std::int32_t last = cells_ < 3 ? cells_ - 1 : around, first = cells_ < 3 ? 0 : -around;
        for (std::int32_t j = first; j <= last; ++j)
            for (std::int32_t i = first; i <= last; ++i)
                for (const Pebble& other : grid_[index(cx + i, cy + j)]) {
                    const double dx = wrapped(other.x - pebble.x, side_);
                    const double dy = wrapped(other.y - pebble.y, side_);
                    const double apart =
                        spacing * (radius_towards(pebble, dx, dy) + radius_towards(other, dx, dy));
                    if (dx * dx + dy * dy < apart * apart) return false;
                }
        return true;
    }

    void add(const Pebble& pebble) { grid_[index(cell_of(pebble.x), cell_of(pebble.y))].push_back(pebble); }

  private:
    std::int32_t cell_of(double at) const {
        return std::min(cells_ - 1, static_cast<std::int32_t>(at / side_ * cells_));
    }
    std::size_t index(std::int32_t x, std::int32_t y) const {
        return std::size_t((y + cells_) % cells_) * std::size_t(cells_) + std::size_t((x + cells_) % cells_);
    }

    double side_;
    std::int32_t cells_;
    std::vector<std::vector<Pebble>> grid_;
};

void lay_sand(PebblePile& pile, std::uint32_t salt) {
    const double cell = 24.0 * pile.texel;
    const auto period = std::max(1, static_cast<std::int32_t>(pile.side / cell));
    const double scale = static_cast<double>(period) / pile.side;
    for (std::int32_t y = 0; y < pile.side; ++y)
        for (std::int32_t x = 0; x < pile.side; ++x)
            pile.height[pile.index(x, y)] =
                static_cast<float>(pile.texel * 2.5 * fractal_noise(x * scale, y * scale, salt, 5, period));
}

/// Lets a stone down until it rests: it takes the mean height and slope of what lies under it.
void settle(const PebblePile& pile, Pebble& pebble, double sink) {
    const double extent = reach(pebble) / 1.4;
    const double step = std::max(1.0, extent / 10.0);
    double count = 0, sum = 0, sum_x = 0, sum_y = 0, squares = 0;
    for (double dy = -extent; dy <= extent; dy += step)
        for (double dx = -extent; dx <= extent; dx += step) {
            const auto [u, v] = to_pebble(pebble, dx, dy);
            if (u * u + v * v > 0.9) continue;
            const double h = static_cast<double>(
                pile.height[pile.index(static_cast<std::int32_t>(whole_below(pebble.x + dx)),
                                       static_cast<std::int32_t>(whole_below(pebble.y + dy)))]);
            count += 1;
            sum += h;
            sum_x += h * dx;
            sum_y += h * dy;
            squares += 0.5 * (dx * dx + dy * dy);
        }
    const double steepest = 0.28;
    pebble.tilt_x += std::clamp(0.7 * sum_x / std::max(squares, 1.0), -steepest, steepest);
    pebble.tilt_y += std::clamp(0.7 * sum_y / std::max(squares, 1.0), -steepest, steepest);
    pebble.base = sum / std::max(count, 1.0) + (0.55 - sink) * pebble.half_height;
}

void lay(PebblePile& pile, const Pebble& pebble) {
    const auto id = static_cast<std::int32_t>(pile.pebbles.size());
    pile.pebbles.push_back(pebble);
    const double extent = reach(pebble);
    const auto left = static_cast<std::int32_t>(whole_below(pebble.x - extent));
    const auto top = static_cast<std::int32_t>(whole_below(pebble.y - extent));
    const auto span = static_cast<std::int32_t>(2.0 * extent) + 2;
    for (std::int32_t y = top; y < top + span; ++y)
        for (std::int32_t x = left; x < left + span; ++x) {
            const double h = surface_height(pebble, x + 0.5 - pebble.x, y + 0.5 - pebble.y);
            const std::size_t at = pile.index(x, y);
            if (h <= static_cast<double>(pile.height[at])) continue;
            pile.height[at] = static_cast<float>(h);
            pile.owner[at] = id;
        }
}

}  // namespace

PebblePile lay_pebbles(std::int32_t side, double texel, std::uint64_t seed, const std::stop_token& stop) {
    PebblePile pile;
    pile.side = side;
    pile.texel = texel;
    pile.height.resize(std::size_t(side) * std::size_t(side));
    pile.owner.assign(pile.height.size(), -1);
    lay_sand(pile, static_cast<std::uint32_t>(mix(seed ^ stream("sand"))));

    std::uint64_t number = 0;
    for (const Bed& bed : beds) {
        Dice dice{mix(seed ^ stream("bed", number++))};
        Bedding bedding{side, 2.8 * bed.largest * texel};
        // A stone larger than a third of the canvas would meet itself across the border
        double radius = bed.largest * texel;
        for (; radius >= bed.smallest * texel; radius *= bed.shrink) {
            if (radius * 6.0 > side) continue;
            const double places = static_cast<double>(side) * side / (4.0 * radius * radius);
            for (auto left = static_cast<std::int64_t>(places * bed.tries) + 1; left > 0; --left) {
                if (stop.stop_requested()) return pile;
                Pebble pebble = make_pebble(radius * dice.uniform(0.92, 1.08), dice);
                pebble.x = dice.uniform(0.0, side);
                pebble.y = dice.uniform(0.0, side);
                if (!bedding.fits(pebble, bed.spacing)) continue;
                pebble.tilt_x = dice.uniform(-0.10, 0.10);
                pebble.tilt_y = dice.uniform(-0.10, 0.10);
                settle(pile, pebble, bed.sink);
                bedding.add(pebble);
                lay(pile, pebble);
            }
        }
    }
    return pile;
}

}  // namespace tessera
