#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "client/residency/camera.h"

namespace tessera {

class HeightImage;

/// What the texture lies on. Page table, filters and cache are the same for all.
struct Surface {
    enum class Kind : std::uint8_t {
        plane,    ///< z = 0.
        terrain,  ///< Hills over the plane, which the texture is projected down on; the mesh knows no texels.
        corridor,  ///< A square tunnel along y, into which the texture is folded.
    };
    Kind kind = Kind::plane;

    /// Of a terrain: how much higher than without it its hills are; 1: as they were made, or in the image one
    /// texel a code of 8 bits. 0 to 1000.
    double relief = 1;
    /// Of a terrain: heights from a picture; none: hills of all sizes, made from integers.
    std::shared_ptr<const HeightImage> heights{};

    /// Of a corridor: the texel in the middle between its walls, and how far it is from there to each of the
    /// four sides, in texels of level 0; more than 0.
    std::int64_t middle_x = 0;
    double half_side = 1024;

    bool operator==(const Surface&) const = default;
};

/// The word for it in options and files.
constexpr std::string_view name_of(Surface::Kind kind) noexcept {
    return kind == Surface::Kind::plane ? "plane" : kind == Surface::Kind::terrain ? "terrain" : "corridor";
}

constexpr std::optional<Surface::Kind> surface_named(std::string_view name) noexcept {
    for (const auto kind : {Surface::Kind::plane, Surface::Kind::terrain, Surface::Kind::corridor})
        if (name_of(kind) == name) return kind;
    return std::nullopt;
}

/// A corridor as it stands around a camera: its middle above that, its sides as far as the floor. Other
/// surfaces as they are.
Surface around(Surface surface, const Camera& camera);

/// How high the surface is under the eye, above the plane: a camera's height counts from there, so that no
/// path leads into a hill. Texels.
double base_height(const Surface& surface, const PlanePoint& ground);

}  // namespace tessera
