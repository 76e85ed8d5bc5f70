#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "server/scenes/noise.h"
#include "server/scenes/pebble.h"
#include "shared/page/texel_image.h"

namespace tessera::painting {

/// A rectangle of a canvas, in texels of the finished picture.
struct Box {
    double left = 0, top = 0, right = 0, bottom = 0;
};

/// What is painted at one place.
struct Paint {
    double height = 0;  ///< In texels above the ground.
    LinearColor color{};
    double alpha = 1;  ///< How much of what is below it hides, 0 to 1.
};

/// A square on which things of all heights are laid: the highest is seen. It is finer than the finished
/// picture, and light falls on it only when it is developed. Coordinates are texels of the finished picture,
/// from its top-left corner. The same calls give the same bytes on every machine: +, −, ×, ÷ and square roots
/// only.
class Canvas {
  public:
    /// `grain`: samples along the side of a texel.
    Canvas(std::int32_t side, std::int32_t grain);

    std::int32_t side() const noexcept { return side_; }
    double height(double x, double y) const noexcept { return double{height_[at(x, y)]}; }

    /// Paints whatever lies in `box`: paint(x, y, Paint&) says whether there is anything at (x, y). Its
    /// slopes are taken from its own heights, and its edge falls off.
    template <typename F>
    void draw(const Box& box, F&& paint);

    /// Covers all of it: each sample is painted once, and slopes are taken from the heights beside it.
    template <typename F>
    void fill(F&& paint);

    struct Light {
        double sun = 1, sky = 1;
        double shade = 1;     ///< How dark what stands lower than its surroundings becomes.
        bool shadows = true;  ///< Cast by the sun.
        double glow = 0;      ///< Light through thin leaves, as a part of their colour.
        double level = 1;     ///< Of all light.
    };
    /// The finished picture in light: sRGB codes, alpha straight.
    Rgba8Image develop(const Light& light) const;

  private:
    static constexpr double cliff = 1.6;  ///< Slope of an edge.
    std::size_t at(double x, double y) const noexcept;
    void take_slopes();
    std::vector<float> blurred(std::int32_t radius) const;
    double sunlight(std::int32_t x, std::int32_t y) const noexcept;

    std::int32_t side_, grain_, samples_;
    std::vector<float> height_, alpha_, slope_x_, slope_y_;
    std::vector<LinearColor> color_;
};

template <typename F>
void Canvas::draw(const Box& box, F&& paint) {
    const auto bound = [this](double texel) {
        return static_cast<std::int32_t>(std::clamp<std::int64_t>(whole_below(texel * grain_), 0, samples_));
    };
    const std::int32_t left = bound(box.left), right = std::min(samples_, bound(box.right) + 1);
    const std::int32_t top = bound(box.top), bottom = std::min(samples_, bound(box.bottom) + 1);
    const double step = 1.0 / grain_;
    for (std::int32_t j = top; j < bottom; ++j)
        for (std::int32_t i = left; i < right; ++i) {
            const double x = (i + 0.5) * step, y = (j + 0.5) * step;
            Paint here;
            if (!paint(x, y, here)) continue;
            const std::size_t k = std::size_t(j) * std::size_t(samples_) + std::size_t(i);
            if (here.height <= double{height_[k]} && alpha_[k] > 0) continue;
            Paint beside;
            const double across = paint(x + step, y, beside) ? (beside.height - here.height) / step : -cliff;
            Paint below;
            const double down = paint(x, y + step, below) ? (below.height - here.height) / step : -cliff;
            const double a = here.alpha, under = double{alpha_[k]} * (1.0 - a);
            const double whole = a + under;
            for (std::size_t c = 0; c < 3; ++c)
                color_[k][c] = whole > 0 ? (here.color[c] * a + color_[k][c] * under) / whole : 0.0;
            slope_x_[k] = static_cast<float>(std::clamp(across, -cliff, cliff));
            slope_y_[k] = static_cast<float>(std::clamp(down, -cliff, cliff));
            height_[k] = static_cast<float>(here.height);
            alpha_[k] = static_cast<float>(whole);
        }
}

template <typename F>
void Canvas::fill(F&& paint) {
    const double step = 1.0 / grain_;
    std::size_t k = 0;
    for (std::int32_t j = 0; j < samples_; ++j)
        for (std::int32_t i = 0; i < samples_; ++i, ++k) {
            Paint here;
            paint((i + 0.5) * step, (j + 0.5) * step, here);
            color_[k] = here.color;
            height_[k] = static_cast<float>(here.height);
            alpha_[k] = 1;
        }
    take_slopes();
}

/// Lays one patterned square beside another, rows from the top, `columns` a row, on one sheet.
Rgba8Image sheet_of(const std::vector<Rgba8Image>& patterns, std::int32_t columns);

/// What paint(i) paints for i from 0 on; runs several at a time.
template <typename F>
std::vector<Rgba8Image> paint_all(std::int32_t count, F&& paint) {
    std::vector<Rgba8Image> painted(static_cast<std::size_t>(count));
    std::atomic<std::int32_t> next{0};
    std::vector<std::jthread> painters;
    const auto hands = std::clamp(static_cast<std::int32_t>(std::thread::hardware_concurrency()), 1, 16);
    for (std::int32_t hand = 0; hand < hands; ++hand)
        painters.emplace_back([&] {
            for (std::int32_t i = next++; i < count; i = next++)
                painted[static_cast<std::size_t>(i)] = paint(i);
        });
    painters.clear();
    return painted;
}

}  // namespace tessera::painting
