#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "shared/math/footprint.h"

namespace tessera {

/// A flat surface as a camera sees it: (s, t, w) = to_texels·(px, py, 1) for a point (px, py) of the screen
/// in pixels, y down; s/w and t/w are texels from the situation's origin, and w > 0 is the reciprocal of the
/// distance along the viewing direction. Because w is linear in the pixel, the surface with the greatest w is
/// the one that is seen.
struct SituationSurface {
    std::array<double, 9> to_texels{};  ///< Rows of a 3×3 matrix.
};

/// A view on which filters are compared, the same for the server's filters and for a GPU's.
struct Situation {
    std::string_view name;               ///< "grazing-plane", "checker-horizon", "corridor"
    std::string_view title;              ///< For people.
    std::int32_t width = 0, height = 0;  ///< Pixels.
    std::vector<SituationSurface> surfaces;
    std::int64_t origin_x = 0, origin_y = 0;  ///< The texel that texels are counted from.
};

/// The three situations of the line-integral paper (section 4): a plane at a grazing angle, a checker to the
/// horizon, a game-like corridor. Widths and heights are scaled from 800×700; at least 16 pixels.
std::vector<Situation> situations(std::int32_t width, std::int32_t height);

/// The surface behind the middle of pixel (px, py), or nothing: sky.
std::optional<std::size_t> surface_at(const Situation& situation, std::int32_t px, std::int32_t py) noexcept;

/// What pixel (px, py) must average: the quadrilateral that its outline subtends on the surface behind its
/// middle. Nothing for the sky, and for a pixel with a corner beyond the surface's horizon.
std::optional<Footprint> footprint_of(const Situation& situation, std::int32_t px, std::int32_t py) noexcept;

}  // namespace tessera
