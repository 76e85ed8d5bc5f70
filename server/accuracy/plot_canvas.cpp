#include "server/accuracy/plot_canvas.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include "server/quality/small_text.h"

namespace tessera {
namespace {

constexpr const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

std::int32_t pixel(double at) { return static_cast<std::int32_t>(std::floor(at)); }

}  // namespace

PlotCanvas::PlotCanvas(std::int32_t width, std::int32_t height)
    : width_{width}, height_{height}, large_(width * scale, height * scale) {
    std::ranges::fill(large_.bytes, std::uint8_t{255});
}

void PlotCanvas::put(std::int32_t x, std::int32_t y, const PlotColor& color) noexcept {
    if (x < 0 || y < 0 || x >= large_.width || y >= large_.height) return;
    std::ranges::copy(color, large_.row(y) + std::ptrdiff_t{4} * x);
}

void PlotCanvas::rectangle(double x0, double y0, double x1, double y1, const PlotColor& color) {
    for (std::int32_t y = pixel(y0 * scale); y < pixel(y1 * scale); ++y)
        for (std::int32_t x = pixel(x0 * scale); x < pixel(x1 * scale); ++x) put(x, y, color);
}

void PlotCanvas::line(double x0, double y0, double x1, double y1, double width, const PlotColor& color) {
    const double reach = width * scale / 2;
    const double ax = x0 * scale, ay = y0 * scale, dx = x1 * scale - ax, dy = y1 * scale - ay;
    const double square = dx * dx + dy * dy;
    for (std::int32_t y = pixel(std::min(ay, ay + dy) - reach); y <= pixel(std::max(ay, ay + dy) + reach);
         ++y)
        for (std::int32_t x = pixel(std::min(ax, ax + dx) - reach); x <= pixel(std::max(ax, ax + dx) + reach);
             ++x) {
            const double px = x + 0.5 - ax, py = y + 0.5 - ay;
            const double t = square > 0 ? std::clamp((px * dx + py * dy) / square, 0.0, 1.0) : 0;
            if (std::hypot(px - t * dx, py - t * dy) <= reach) put(x, y, color);
        }
}

void PlotCanvas::disc(double x, double y, double radius, const PlotColor& color) {
    line(x, y, x, y, 2 * radius, color);
}

void PlotCanvas::text(double x, double y, double size, std::string_view words, const PlotColor& color,
                      Anchor anchor) {
    std::error_code failure;
    if (std::filesystem::exists(font, failure)) {
        OIIO::ImageBuf picture(OIIO::ImageSpec(large_.width, large_.height, 4, OIIO::TypeDesc::UINT8),
                               large_.bytes.data());
        const std::array ink{float(color[0]) / 255, float(color[1]) / 255, float(color[2]) / 255, 1.0F};
        using OIIO::ImageBufAlgo::TextAlignX;
        const auto side = anchor == Anchor::left     ? TextAlignX::Left
                          : anchor == Anchor::centre ? TextAlignX::Center
                                                     : TextAlignX::Right;
        if (OIIO::ImageBufAlgo::render_text(picture, pixel(x * scale), pixel(y * scale), std::string{words},
                                            pixel(size * scale), font, OIIO::cspan<float>(ink.data(), 4),
                                            side, OIIO::ImageBufAlgo::TextAlignY::Baseline))
            return;
    }
    const auto letters = std::max(1, pixel(size * scale / 10));
    const double width = text_width(words, letters);
    const double left = x * scale - (anchor == Anchor::left     ? 0
                                     : anchor == Anchor::centre ? width / 2
                                                                : width);
    draw_text(large_, pixel(left), pixel(y * scale) - letter_height * letters, words, letters, color);
}

Rgba8Image PlotCanvas::finished() const {
    Rgba8Image out(width_, height_);
    for (std::int32_t y = 0; y < height_; ++y)
        for (std::int32_t x = 0; x < width_; ++x)
            for (std::int32_t c = 0; c < 4; ++c) {
                int sum = scale * scale / 2;
                for (std::int32_t v = 0; v < scale; ++v)
                    for (std::int32_t u = 0; u < scale; ++u)
                        sum += large_.row(y * scale + v)[4 * (x * scale + u) + c];
                out.row(y)[4 * x + c] = static_cast<std::uint8_t>(sum / (scale * scale));
            }
    return out;
}

}  // namespace tessera
