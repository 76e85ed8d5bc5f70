#pragma once

#include <cstdint>

namespace tessera {

/// Smooth noise for painting: made of integers and +, −, ×, ÷ only, so that a painting is the same on every
/// machine.

/// Gradient noise about −1 to 1, zero at whole coordinates (Perlin, "Improving noise", SIGGRAPH 2002). `salt`
/// picks one of many fields. With a `period` above 0 the field repeats after that many units in x and y.
double noise(double x, double y, std::uint32_t salt, std::int32_t period = 0) noexcept;

/// Octaves of noise, each twice as fine and half as strong, about −1 to 1.
double fractal_noise(double x, double y, std::uint32_t salt, int octaves, std::int32_t period = 0) noexcept;

/// The largest whole number at most `x`; std::floor is a call on the oldest processors we build for.
constexpr std::int64_t whole_below(double x) noexcept {
    const auto whole = static_cast<std::int64_t>(x);
    return whole - (static_cast<double>(whole) > x ? 1 : 0);
}

/// 0 below `from`, 1 above `to`, a smooth step between; `from` may be above `to`.
constexpr double smooth_step(double from, double to, double value) noexcept {
    const double t = (value - from) / (to - from);
    const double clamped = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    return clamped * clamped * (3.0 - 2.0 * clamped);
}

constexpr double mix_linear(double a, double b, double t) noexcept { return a + (b - a) * t; }

/// A stream of random numbers, each a hash of its place in the stream.
class Dice {
  public:
    explicit Dice(std::uint64_t key) noexcept : key_{key} {}
    std::uint64_t bits() noexcept;
    /// Uniform in [from, to).
    double uniform(double from, double to) noexcept;
    bool chance(double probability) noexcept { return uniform(0.0, 1.0) < probability; }

  private:
    std::uint64_t key_;
    std::int64_t drawn_ = 0;
};

}  // namespace tessera
