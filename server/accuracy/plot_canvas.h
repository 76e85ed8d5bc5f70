#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "shared/page/texel_image.h"

namespace tessera {

using PlotColor = std::array<std::uint8_t, 3>;

/// Where a text lies about its point.
enum class Anchor : std::uint8_t { left, centre, right };

/// A white picture to draw on, in pixels; edges are smooth, since it is drawn four times as large.
class PlotCanvas {
  public:
    PlotCanvas(std::int32_t width, std::int32_t height);

    void rectangle(double x0, double y0, double x1, double y1, const PlotColor& color);
    void line(double x0, double y0, double x1, double y1, double width, const PlotColor& color);
    void disc(double x, double y, double radius, const PlotColor& color);
    /// `y` is the baseline. In DejaVu Sans where the machine has it, else in letters of our own.
    void text(double x, double y, double size, std::string_view words, const PlotColor& color,
              Anchor anchor = Anchor::left);

    Rgba8Image finished() const;

  private:
    static constexpr std::int32_t scale = 4;
    void put(std::int32_t x, std::int32_t y, const PlotColor& color) noexcept;
    std::int32_t width_, height_;
    Rgba8Image large_;
};

}  // namespace tessera
