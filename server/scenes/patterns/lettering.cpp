#include "server/scenes/patterns/lettering.h"

#include <algorithm>

namespace tessera::painting {
namespace {

constexpr std::int32_t letter_width = 4, letter_height = 6, letter_step = 6;  ///< In units.
constexpr double half_stroke = 0.46, rim_width = 0.10;

/// Strokes as pairs of points on a grid of 5 × 7: column and row.
std::string_view strokes_of(char letter) {
    switch (letter) {
        case 'A':
            return "0620 2046 1434";
        case 'C':
            return "4130 3010 1001 0105 0516 1636 3645";
        case 'E':
            return "4000 0006 0646 0333";
        case 'L':
            return "0006 0646";
        case 'R':
            return "0600 0030 3041 4142 4233 3303 2346";
        case 'S':
            return "4130 3010 1001 0102 0213 1333 3344 4445 4536 3616 1605";
        case 'T':
            return "0040 2026";
        case 'V':
            return "0026 2640";
        case 'X':
            return "0046 4006";
        case 'Y':
            return "0023 4023 2326";
        default:
            return {};
    }
}

struct Stroke {
    double x, y, dx, dy;
};

std::vector<Stroke> parsed(std::string_view text) {
    std::vector<Stroke> strokes;
    std::vector<double> digits;
    for (const char c : text)
        if (c != ' ') digits.push_back(c - '0');
    for (std::size_t i = 0; i + 4 <= digits.size(); i += 4)
        strokes.push_back(
            {digits[i], digits[i + 1], digits[i + 2] - digits[i], digits[i + 3] - digits[i + 1]});
    return strokes;
}

/// The square of the distance from a point to a stroke.
double distance_squared(const Stroke& stroke, double x, double y) noexcept {
    const double px = x - stroke.x, py = y - stroke.y;
    const double t = std::clamp(
        (px * stroke.dx + py * stroke.dy) / (stroke.dx * stroke.dx + stroke.dy * stroke.dy), 0.0, 1.0);
    const double ex = px - t * stroke.dx, ey = py - t * stroke.dy;
    return ex * ex + ey * ey;
}

}  // namespace

void write_text(Board& board, std::string_view text, std::int32_t unit, std::uint8_t inside,
                std::uint8_t rim) {
    const auto letters = static_cast<std::int32_t>(text.size());
    const std::int32_t left = (board.width - (letters * letter_step - 2) * unit) / 2;
    const std::int32_t top = (board.height - letter_height * unit) / 2;
    const double within = (half_stroke - rim_width) * (half_stroke - rim_width);
    for (std::int32_t letter = 0; letter < letters; ++letter) {
        const std::vector<Stroke> strokes = parsed(strokes_of(text[static_cast<std::size_t>(letter)]));
        if (strokes.empty()) continue;
        const std::int32_t origin = left + letter * letter_step * unit;
        for (std::int32_t y = std::max(0, top - unit); y < std::min(board.height, top + 7 * unit); ++y)
            for (std::int32_t x = std::max(0, origin - unit);
                 x < std::min(board.width, origin + (letter_width + 1) * unit); ++x) {
                double nearest = 1;
                for (const Stroke& stroke : strokes)
                    nearest = std::min(
                        nearest, distance_squared(stroke, (x - origin + 0.5) / unit, (y - top + 0.5) / unit));
                if (nearest >= half_stroke * half_stroke) continue;
                board.codes[static_cast<std::size_t>(y) * static_cast<std::size_t>(board.width) +
                            static_cast<std::size_t>(x)] = nearest < within ? inside : rim;
            }
    }
}

}  // namespace tessera::painting
