#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/scenes/pebble.h"

namespace tessera {

/// Stones laid one on another on a square of sand whose borders meet: what lies across the right border is
/// at the left one.
struct PebblePile {
    std::int32_t side = 0;            ///< Texels of the canvas.
    double texel = 1;                 ///< Canvas texels for one texel of the finished picture.
    std::vector<Pebble> pebbles;      ///< In the order they were laid.
    std::vector<float> height;        ///< side², of what is on top.
    std::vector<std::int32_t> owner;  ///< side², which pebble that is, or −1: sand.

    /// `x` and `y` may be up to a side beyond the borders.
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return std::size_t(inside(y)) * std::size_t(side) + std::size_t(inside(x));
    }
    std::int32_t inside(std::int32_t i) const noexcept {
        return i < 0 ? i + side : (i < side ? i : i - side);
    }
};

/// The same arguments give the same pile on every machine. `texel` scales all sizes. Once `stop` is asked
/// for, no more stones are laid.
PebblePile lay_pebbles(std::int32_t side, double texel, std::uint64_t seed, const std::stop_token& stop = {});

}  // namespace tessera
