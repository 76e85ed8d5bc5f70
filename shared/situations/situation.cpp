#include "shared/situations/situation.h"

#include <cmath>

namespace tessera {

namespace {

/// x to the right, y down, z away, in units of the eye's height.
struct Vector {
    double x = 0, y = 0, z = 0;
};

constexpr double dot(Vector a, Vector b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr Vector cross(Vector a, Vector b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Cosine and sine, written out: libm differs between machines.
struct Angle {
    double cosine = 1, sine = 0;
};
constexpr Angle degrees_0{};
constexpr Angle degrees_3{0.998629534754573873784, 0.0523359562429438327222};
constexpr Angle degrees_8{0.990268068741570361979, 0.139173100960065444112};
constexpr Angle degrees_12{0.978147600733805637929, 0.207911690817759337102};
constexpr Angle degrees_20{0.939692620785908384054, 0.342020143325668733044};
constexpr double tangent_of_25_degrees = 0.466307658154998592839;

constexpr double texels_a_unit = 512;

struct Camera {
    Vector forward, right, down;
    double width = 0, height = 0;  ///< Pixels; the picture is 50° high.
};

Camera camera(Angle yaw, Angle pitch_down, std::int32_t width, std::int32_t height) {
    const Vector forward{yaw.sine * pitch_down.cosine, pitch_down.sine, yaw.cosine * pitch_down.cosine};
    const Vector right{yaw.cosine, 0, -yaw.sine};
    return {forward, right, cross(forward, right), static_cast<double>(width), static_cast<double>(height)};
}

/// The plane normal·X = distance, textured along two directions.
struct Plane {
    Vector normal;
    double distance = 1;  ///< From the eye, more than 0.
    Vector along_s, along_t;
    double offset_s = 0, offset_t = 0;  ///< Texels of the point before the eye.
};

SituationSurface seen_by(const Camera& camera, const Plane& plane) {
    // The ray through a pixel is forward + (px − w/2)/f·right + (py − h/2)/f·down: a function linear on it is
    // linear in the pixel
    const double focal = camera.height / 2 / tangent_of_25_degrees;
    const auto row = [&](Vector v, double* out) {
        out[0] = dot(v, camera.right) / focal;
        out[1] = dot(v, camera.down) / focal;
        out[2] = dot(v, camera.forward) - out[0] * camera.width / 2 - out[1] * camera.height / 2;
    };
    const auto scaled = [](Vector v, double by) { return Vector{v.x * by, v.y * by, v.z * by}; };
    SituationSurface surface;
    double* m = surface.to_texels.data();
    row(scaled(plane.normal, 1 / plane.distance), m + 6);
    row(scaled(plane.along_s, texels_a_unit), m);
    row(scaled(plane.along_t, texels_a_unit), m + 3);
    for (int i = 0; i < 3; ++i) {
        m[i] += plane.offset_s * m[6 + i];
        m[3 + i] += plane.offset_t * m[6 + i];
    }
    return surface;
}

constexpr Plane ground{{0, 1, 0}, 1, {1, 0, 0}, {0, 0, 1}, 37.25, 11.5};

struct ScreenPoint {
    double s = 0, t = 0, w = 0;
};

ScreenPoint project(const SituationSurface& surface, double px, double py) noexcept {
    const auto& m = surface.to_texels;
    return {m[0] * px + m[1] * py + m[2], m[3] * px + m[4] * py + m[5], m[6] * px + m[7] * py + m[8]};
}

}  // namespace

std::vector<Situation> situations(std::int32_t width, std::int32_t height) {
    const Camera grazing = camera(degrees_20, degrees_12, width, height);
    const Camera level = camera(degrees_0, degrees_3, width, height);
    const Camera walking = camera(degrees_8, degrees_3, width, height);
    // Wider than high, the eye nearer to the right wall: every wall is seen at another angle
    const Plane ceiling{{0, -1, 0}, 1.4, {1, 0, 0}, {0, 0, 1}, 5.75, 301.5};
    const Plane left{{-1, 0, 0}, 1.7, {0, 0, 1}, {0, 1, 0}, 91.5, 17.25};
    const Plane right{{1, 0, 0}, 1.1, {0, 0, 1}, {0, 1, 0}, 203.25, 60.5};
    return {{"grazing-plane", "A plane at a grazing angle", width, height, {seen_by(grazing, ground)}, 0, 0},
            {"checker-horizon", "A plane to the horizon", width, height, {seen_by(level, ground)}, 0, 0},
            {"corridor",
             "A corridor, as in a game",
             width,
             height,
             {seen_by(walking, ground), seen_by(walking, ceiling), seen_by(walking, left),
              seen_by(walking, right)},
             0,
             0}};
}

std::optional<std::size_t> surface_at(const Situation& situation, std::int32_t px, std::int32_t py) noexcept {
    std::optional<std::size_t> nearest;
    double greatest = 0;
    for (std::size_t i = 0; i < situation.surfaces.size(); ++i) {
        const double w = project(situation.surfaces[i], px + 0.5, py + 0.5).w;
        if (w <= greatest) continue;
        greatest = w;
        nearest = i;
    }
    return nearest;
}

std::optional<Footprint> footprint_of(const Situation& situation, std::int32_t px, std::int32_t py) noexcept {
    const std::optional<std::size_t> surface = surface_at(situation, px, py);
    if (!surface) return std::nullopt;
    std::array<TexelPoint, 4> corners;
    constexpr std::array<std::array<std::int32_t, 2>, 4> around{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (std::size_t i = 0; i < 4; ++i) {
        const ScreenPoint p = project(situation.surfaces[*surface], px + around[i][0], py + around[i][1]);
        if (!(p.w > 0)) return std::nullopt;
        corners[i] = {p.s / p.w, p.t / p.w};
        if (!(std::fabs(corners[i].x) < 0x1p39) || !(std::fabs(corners[i].y) < 0x1p39)) return std::nullopt;
    }
    // Counted from a whole texel close by
    const double x = std::floor(corners[0].x), y = std::floor(corners[0].y);
    for (TexelPoint& corner : corners) corner = {corner.x - x, corner.y - y};
    return Footprint{situation.origin_x + static_cast<std::int64_t>(x),
                     situation.origin_y + static_cast<std::int64_t>(y), corners, 0};
}

}  // namespace tessera
