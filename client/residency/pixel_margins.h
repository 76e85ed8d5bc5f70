#pragma once

#include <cmath>

#include "client/residency/plane_view.h"

namespace tessera {

// How far the shader's floats may be off
inline constexpr double level_margin = 0.003;
inline constexpr double texel_margin = 0.04;
inline constexpr double ratio_margin = 1e-4;

inline GroundPoint operator+(GroundPoint a, GroundPoint b) { return {a.x + b.x, a.y + b.y}; }
inline GroundPoint operator-(GroundPoint a, GroundPoint b) { return {a.x - b.x, a.y - b.y}; }
inline GroundPoint operator*(double s, GroundPoint p) { return {s * p.x, s * p.y}; }
inline double length(GroundPoint p) { return std::sqrt(p.x * p.x + p.y * p.y); }

}  // namespace tessera
