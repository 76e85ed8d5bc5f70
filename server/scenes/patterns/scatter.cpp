#include "server/scenes/patterns/scatter.h"

#include <array>

namespace tessera::painting {
namespace {

bool crosses(double from, double to, double side) noexcept { return from < 0 || to > side; }

/// Where a border is asked: the border itself, if [from, to] crosses one.
double asked(double at, double from, double to, double side) noexcept {
    if (from < 0 && to > 0) return 0;
    return from < side && to > side ? side : at;
}

}  // namespace

void scatter(Canvas& tile, const Scatter& what) {
    const double side = tile.side();
    const auto lay = [&](std::uint64_t key, bool on_border) {
        Dice dice{key};
        const auto count = static_cast<std::int32_t>(what.count);
        for (std::int32_t i = 0; i < count; ++i) {
            Dice own{dice.bits()};
            const double x = own.uniform(0, side), y = own.uniform(0, side);
            const Thing thing = what.make(own, x, y);
            const bool does_cross = crosses(x + thing.reach.left, x + thing.reach.right, side) ||
                                    crosses(y + thing.reach.top, y + thing.reach.bottom, side);
            if (does_cross != on_border) continue;
            if (!on_border) {
                if (!what.may_be || what.may_be(x, y)) thing.paint(tile, x, y);
                continue;
            }
            for (const double dy : {-side, 0.0, side})
                for (const double dx : {-side, 0.0, side}) {
                    const double px = x + dx, py = y + dy;
                    const double left = px + thing.reach.left, right = px + thing.reach.right;
                    const double top = py + thing.reach.top, bottom = py + thing.reach.bottom;
                    if (right <= 0 || left >= side || bottom <= 0 || top >= side) continue;
                    if (!what.may_be ||
                        what.may_be(asked(px, left, right, side), asked(py, top, bottom, side)))
                        thing.paint(tile, px, py);
                }
        }
    };
    if (what.crossing) lay(what.border_key, true);
    lay(what.own_key, false);
}

double inner(double x, double y, double side, double margin) noexcept {
    const double near = std::min(std::min(x, side - x), std::min(y, side - y));
    return smooth_step(0.0, margin, near);
}

double tile_noise(double x, double y, double side, std::int32_t cells, std::uint32_t border_salt,
                  std::uint32_t own_salt, int octaves) noexcept {
    const double u = x / side * cells, v = y / side * cells;
    const double mine = inner(x, y, side, side * 0.3);
    const double border = mine < 1 ? fractal_noise(u, v, border_salt, octaves, cells) : 0.0;
    const double own = mine > 0 ? fractal_noise(u, v, own_salt, octaves, cells) : 0.0;
    return mix_linear(border, own, mine);
}

}  // namespace tessera::painting
