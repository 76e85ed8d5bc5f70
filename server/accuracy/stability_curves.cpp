#include "server/accuracy/stability_curves.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr std::size_t dark_texels = 16;

std::uint16_t dark(std::size_t x, std::size_t y) {
    return srgb_to_steps[10 + hash(1, stream("dark"), std::int64_t(x), std::int64_t(y)) % 31];
}

double codes(double steps) { return std::fabs(steps) * 255 / double(linear_one); }

}  // namespace

ColumnErrors column_errors(std::size_t length) {
    float bright = 0;
    std::uint32_t bright_steps = 0;
    for (std::size_t i = 0; i < length; ++i) {
        bright += 1.0F;
        bright_steps += 65535;
    }
    ColumnErrors worst;
    float sum = bright;
    std::uint32_t steps = bright_steps;
    double right = 0;
    for (std::size_t i = 0; i < dark_texels; ++i) {
        const std::uint16_t texel = dark(i, 0);
        sum += static_cast<float>(texel) / linear_one;
        steps += texel;
        right += texel;
        const auto count = static_cast<double>(i + 1);
        worst.floats =
            std::max(worst.floats, codes((double(sum - bright) * double(linear_one) - right) / count));
        worst.integers = std::max(worst.integers, codes((double(steps - bright_steps) - right) / count));
    }
    return worst;
}

ColumnErrors table_errors(std::size_t side) {
    // Only the last rows of the table are read, but all of it is summed
    const std::size_t begin = side - std::min(side, dark_texels);
    std::vector<float> above(side + 1), row(side + 1);
    std::vector<std::uint32_t> above_steps(side + 1), row_steps(side + 1);
    std::vector<std::vector<float>> kept;
    std::vector<std::vector<std::uint32_t>> kept_steps;
    for (std::size_t y = 0; y < side; ++y) {
        if (y == begin) {
            kept.push_back(above);
            kept_steps.push_back(above_steps);
        }
        float sum = 0;
        std::uint32_t steps = 0;
        for (std::size_t x = 0; x < side; ++x) {
            const std::uint16_t texel = y >= begin && x >= begin ? dark(x - begin, y - begin) : 65535;
            sum += static_cast<float>(texel) / linear_one;
            steps += texel;
            row[x + 1] = above[x + 1] + sum;
            row_steps[x + 1] = above_steps[x + 1] + steps;
        }
        std::swap(above, row);
        std::swap(above_steps, row_steps);
        if (y >= begin) {
            kept.push_back(above);
            kept_steps.push_back(above_steps);
        }
    }
    ColumnErrors worst;
    double right = 0;
    for (std::size_t n = 1; n <= side - begin; ++n) {
        for (std::size_t i = 0; i < n; ++i) right += dark(i, n - 1) + (i + 1 < n ? dark(n - 1, i) : 0);
        const std::size_t end = begin + n;
        const auto area = static_cast<double>(n * n);
        const float floats = (kept[n][end] - kept[n][begin]) - (kept[0][end] - kept[0][begin]);
        const std::uint32_t steps =
            (kept_steps[n][end] - kept_steps[n][begin]) - (kept_steps[0][end] - kept_steps[0][begin]);
        worst.floats = std::max(worst.floats, codes((double(floats) * double(linear_one) - right) / area));
        worst.integers = std::max(worst.integers, codes((double(steps) - right) / area));
    }
    return worst;
}

std::vector<proto::StabilityCurve> stability_curves(int most_length_log2) {
    std::vector<proto::StabilityCurve> curves(4);
    const auto name = [&](std::size_t i, const char* what, const char* over) {
        curves[i].set_name(what);
        curves[i].set_x_name(over);
        curves[i].set_y_name("greatest error, codes of linear light");
    };
    name(0, "column sums in 32-bit floats (the paper)", "texels in the column");
    name(1, "column sums in modular integers (Tessera)", "texels in the column");
    name(2, "summed-area table in 32-bit floats", "side of the table in texels");
    name(3, "summed-area table in modular integers (Tessera)", "side of the table in texels");
    const auto add = [&](std::size_t i, std::size_t x, double y) {
        curves[i].add_x(static_cast<double>(x));
        curves[i].add_y(y);
    };
    for (int log2 = 4; log2 <= most_length_log2; ++log2) {
        const std::size_t length = std::size_t{1} << log2;
        const ColumnErrors errors = column_errors(length);
        add(0, length, errors.floats);
        add(1, length, errors.integers);
    }
    for (int log2 = 5; log2 <= std::min(12, most_length_log2); ++log2) {
        const std::size_t side = std::size_t{1} << log2;
        const ColumnErrors errors = table_errors(side);
        add(2, side, errors.floats);
        add(3, side, errors.integers);
    }
    return curves;
}

}  // namespace tessera
