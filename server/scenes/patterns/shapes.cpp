#include "server/scenes/patterns/shapes.h"

#include <cmath>

namespace tessera::painting {

LinearColor blend(const LinearColor& low, const LinearColor& high, double t) noexcept {
    LinearColor color;
    for (std::size_t c = 0; c < 3; ++c) color[c] = mix_linear(low[c], high[c], t);
    return color;
}

LinearColor blend(const LinearColor& low, const LinearColor& middle, const LinearColor& high,
                  double t) noexcept {
    return t < 0.5 ? blend(low, middle, 2 * t) : blend(middle, high, 2 * t - 1);
}

LinearColor tinted(const LinearColor& color, double lightness, double warmth) noexcept {
    return {color[0] * lightness * (1 + warmth), color[1] * lightness, color[2] * lightness * (1 - warmth)};
}

Direction any_direction(Dice& dice) noexcept {
    double x = 0, y = 0, square = 0;
    do {
        x = dice.uniform(-1, 1);
        y = dice.uniform(-1, 1);
        square = x * x + y * y;
    } while (square > 1 || square < 0.01);
    const double length = std::sqrt(square);
    return {x / length, y / length};
}

Direction turned(Direction d, double share) noexcept {
    share -= static_cast<double>(whole_below(share));
    const double quarter = share * 4;
    const auto whole = static_cast<int>(quarter);
    const double t = quarter - whole;
    for (int i = 0; i < whole; ++i) d = beside(d);
    // Between two right angles: half the angle's tangent is nearly even in the angle
    const double h = 0.41421356237 * (0.95 * t + 0.05 * t * t);
    const double c = (1 - h * h * 1.0) / (1 + h * h), s = 2 * h / (1 + h * h);
    const double c2 = c * c - s * s, s2 = 2 * c * s;
    return {d.x * c2 - d.y * s2, d.x * s2 + d.y * c2};
}

Box box_of(const Blade& b) noexcept {
    const Direction side = beside(b.along);
    const double end_x = b.along.x * b.length, end_y = b.along.y * b.length;
    const double off_x = side.x * b.bend, off_y = side.y * b.bend;
    const double w = b.half_width + 0.3;
    return {b.x + std::min({0.0, end_x, end_x + off_x}) - w, b.y + std::min({0.0, end_y, end_y + off_y}) - w,
            b.x + std::max({0.0, end_x, end_x + off_x}) + w, b.y + std::max({0.0, end_y, end_y + off_y}) + w};
}

void draw_blade(Canvas& canvas, const Blade& b) {
    const Direction side = beside(b.along);
    canvas.draw(box_of(b), [&](double x, double y, Paint& paint) {
        const double dx = x - b.x, dy = y - b.y;
        const double k = (dx * b.along.x + dy * b.along.y) / b.length;
        if (k < 0 || k > 1) return false;
        const double off = dx * side.x + dy * side.y - b.bend * k * k;
        const double outward = k < b.widest ? (b.widest - k) / b.widest : (k - b.widest) / (1 - b.widest);
        const double round = std::sqrt(std::max(0.0, 1 - outward * outward));
        const double pointed = 1 - outward;
        const double half = b.half_width * (k < b.widest ? mix_linear(0.45, 1.0, round)
                                                         : mix_linear(pointed, round, b.blunt));
        if (off > half || off < -half || half <= 0) return false;
        const double across = std::abs(off) / half;
        const double bow = k * (2 - k) - b.sag * k * k;
        paint.height = b.base + b.lift * bow + b.crease * half * (1 - across) * (k < 1 ? 1.0 : 0.0);
        paint.color = blend(b.root_color, b.middle_color, b.tip_color, k);
        if (b.line > 0) {
            const double lit = b.line * smooth_step(0.35, 0.0, across) * smooth_step(1.0, 0.6, k);
            for (double& c : paint.color) c *= 1 + lit;
        }
        return true;
    });
}

Box box_of(const Dome& d) noexcept {
    const double r = std::max(d.half_length, d.half_width) * (1 + 0.25 * d.rough) + 0.2;
    return {d.x - r, d.y - r, d.x + r, d.y + r};
}

void draw_dome(Canvas& canvas, const Dome& d) {
    canvas.draw(box_of(d), [&](double x, double y, Paint& paint) {
        const double dx = x - d.x, dy = y - d.y;
        double u = (dx * d.along.x + dy * d.along.y) / d.half_length;
        double v = (dy * d.along.x - dx * d.along.y) / d.half_width;
        if (d.rough > 0) {
            const double bu = noise(u * 1.2, v * 1.2, d.salt), bv = noise(u * 1.2, v * 1.2, d.salt + 1);
            u += 0.22 * d.rough * bu;
            v += 0.22 * d.rough * bv;
        }
        const double square = u * u + v * v;
        if (square >= 1) return false;
        const double ball = std::sqrt(1 - square), table = std::sqrt(1 - square * square);
        double up = mix_linear(ball, table, d.flat);
        if (d.rough > 0) up += 0.12 * d.rough * noise(u * 2.7, v * 2.7, d.salt + 2);
        paint.height = d.base + d.height * up;
        paint.color = d.color;
        if (d.mottling > 0) {
            const double spot = fractal_noise(dx * 0.55, dy * 0.55, d.salt + 3, 3);
            paint.color = blend(d.color, d.second_color, d.mottling * smooth_step(-0.3, 0.5, spot));
        }
        return true;
    });
}

}  // namespace tessera::painting
