#pragma once

#include <cstdint>
#include <stop_token>

#include "server/texture/rgb8_image.h"

namespace tessera {

inline constexpr std::int32_t min_painting_side = 64;
inline constexpr std::int32_t max_painting_side = 4096;

/// Paints stones of many rocks and sizes that lie on each other in sunlight, as a camera above would see
/// them: the exemplar of the scene `pebbles`. `side` is in texels, min_painting_side to max_painting_side
/// (others are clamped); the stones' size in texels does not depend on it. The picture's borders meet. The
/// same arguments give the same bytes on every machine and compiler: +, −, ×, ÷ and square roots only. Once
/// `stop` is asked for, what is not painted yet stays unpainted.
Rgb8Image paint_pebbles(std::int32_t side, std::uint64_t seed, const std::stop_token& stop = {});

/// The same picture with what it was painted from, texel by texel.
struct PaintedSurface {
    Rgb8Image color;
    Rgb8Image normal;     ///< Of the mean slopes of a flatter relief; x to the right, y up (OpenGL).
    Rgb8Image roughness;  ///< Grey.
    Rgb8Image height;     ///< Grey, from the lowest sand to the highest stone.
};
PaintedSurface paint_pebble_surface(std::int32_t side, std::uint64_t seed, const std::stop_token& stop = {});

}  // namespace tessera
