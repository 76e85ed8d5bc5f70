#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "server/texture/texture.h"
#include "shared/math/image_error.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// Mean squared difference in sRGB codes and greatest difference in codes of linear light, of RGB.
struct PageError {
    double mse = 0, max_linear = 0;
};
inline PageError page_error(const LinearImage& truth, const LinearImage& found) {
    PageError error;
    std::size_t count = 0;
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        if (i % 4 == 3) continue;
        const double a = double(truth.values[i]), b = double(found.values[i]);
        const double d = fractional_srgb_code(b) - fractional_srgb_code(a);
        error.mse += d * d;
        error.max_linear = std::max(error.max_linear, std::fabs(b - a) * 255);
        ++count;
    }
    error.mse /= static_cast<double>(std::max<std::size_t>(count, 1));
    return error;
}

/// Milliseconds of `work`: the median of five runs, of fewer where one takes long.
template <class Work>
double median_milliseconds(Work&& work) {
    std::vector<double> times;
    double total = 0;
    while (times.size() < 5 && (times.empty() || total < 400)) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        times.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
        total += times.back();
    }
    const auto middle = times.begin() + std::ssize(times) / 2;
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
}

/// Means of 2×2 texels; an odd last row or column is left out.
inline LinearImage reduced(const LinearImage& in) {
    LinearImage out(in.width / 2, in.height / 2);
    for (std::int32_t y = 0; y < out.height; ++y) {
        const float *a = in.row(2 * y), *b = in.row(2 * y + 1);
        float* to = out.row(y);
        for (std::int32_t x = 0; x < out.width; ++x, a += 8, b += 8, to += 4)
            for (int c = 0; c < 4; ++c) to[c] = ((a[c] + a[c + 4]) + (b[c] + b[c + 4])) / 4;
    }
    return out;
}

}  // namespace tessera
