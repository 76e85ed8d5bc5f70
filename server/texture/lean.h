#pragma once

#include <array>
#include <cstdint>

#include "server/texture/exchange.h"

namespace tessera {

/// Normal maps as numbers that filter linearly, and what becomes of them once they are filtered:
/// Olano, Baker, "LEAN Mapping", Symposium on Interactive 3D Graphics and Games 2010. The slopes of a normal
/// n, B = (n_x/n_z, n_y/n_z), and their squares and product M = (B_x², B_y², B_x·B_y) are averaged; under a
/// texel the slopes then have the mean B and the covariance Σ = M − B·Bᵀ, which is what the texel's own
/// normal cannot show.
///
/// Precision. Slopes are held in 65535 steps over ±`range`, the steepest one of the images, at most
/// `steepest_slope`; steeper normals are laid down to it, keeping their direction. They are rounded before
/// they are squared. The trace B_x² + B_y² is then a 31-bit integer, held exactly in two values, high and low
/// half: variances in sum are wrong only by the floats of 24 bits that carry means (about 2⁻²³ of the slopes'
/// own size, which is taken off, so that where nothing is lost, exactly nothing shows). How the trace is
/// shared between the axes, B_x² − B_y², and the product B_x·B_y have 32767 steps over range²: right or
/// nearer to isotropic by at most 1.1 steps.

/// tan 76°. Beyond it a texel of any sensible surface is noise, of which one would outweigh a hundred others.
inline constexpr double steepest_slope = 4.0;

struct Slopes {
    double x = 0, y = 0;
};

/// The slopes that three codes of a normal map stand for: n = 2·code/255 − 1, in any length. Normals that
/// point inwards are laid down to steepest_slope.
Slopes slopes_of(std::uint8_t red, std::uint8_t green, std::uint8_t blue) noexcept;

/// The greatest slope along an axis in the image.
double steepest_in(const Rgb8Image& normals) noexcept;

/// B in the first two values. The third is the red channel of `third`, as large, in 255ths; null leaves it 0.
/// `range` is at least steepest_in(normals), and not 0.
Rgb16Image lean_slopes(const Rgb8Image& normals, double range, const Rgb8Image* third);

/// High and low half of the trace of M, and B_x² − B_y².
Rgb16Image lean_squares(const Rgb8Image& normals, double range);

/// squared_alphas() of `roughness`, which is as large, or 0 if it is null; and B_x·B_y.
Rgb16Image lean_products(const Rgb8Image& normals, double range, const Rgb8Image* roughness);

/// What a texel knows of the slopes under it.
struct LeanTexel {
    Slopes mean;
    double trace = 0;  ///< Of Σ: variance_x + variance_y, more precisely.
    double variance_x = 0, variance_y = 0;
    double covariance = 0;
};

/// The mean alone, of filtered lean_slopes().
Slopes lean_mean(const float* slopes, double range) noexcept;

/// From filtered lean_slopes(), lean_squares() and lean_products(): three values each, 0 to 1.
LeanTexel lean_texel(const float* slopes, const float* squares, const float* products, double range) noexcept;

/// How far each is off at most, in slope², if every filtered value is off by `error`; rounding included.
struct LeanError {
    double trace = 0, variance = 0, covariance = 0;
};
LeanError lean_error(double error, double range) noexcept;

/// Roughness filters as the variance that it stands for. A Beckmann lobe of width α scatters slopes with the
/// variance α²/2 along each axis, and α is roughness² (Burley, "Physically Based Shading at Disney", 2012),
/// so α² = code⁴/255⁴: a 32-bit integer, held exactly in two values, high and low half. The third is the red
/// channel of `third`.
Rgb16Image squared_alphas(const Rgb8Image& roughness, const Rgb8Image* third);

/// α² from filtered squared_alphas() or lean_products().
double squared_alpha(const float* halves) noexcept;

/// How far it is off if both halves are off by this part of 1.
double squared_alpha_error(double halves_error) noexcept;

/// LEAN adds what filtering took from the normals to the lobe: α² + 2·σ² along each principal axis of Σ. One
/// number for both axes, as a scalar roughness wants it, takes the mean of their variances, tr Σ / 2, which
/// turns with the surface and keeps the lobe's total spread: α² + tr Σ. Returns roughness, at most 1.
double rougher(double squared_alpha, const LeanTexel& texel) noexcept;

/// √√: of α², without libm.
double roughness_of(double squared_alpha) noexcept;

}  // namespace tessera
