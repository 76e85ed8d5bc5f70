#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "server/quality/lab.h"
#include "server/quality/measures.h"

namespace tessera {
namespace {

constexpr std::int32_t sample_side = 4096;
constexpr std::int32_t coarse_sample_side = 1024;
constexpr std::int32_t strip_rows = 64;
constexpr std::int32_t farthest = 3;  ///< Tiles each way.
constexpr std::int32_t farther = 8;   ///< The same, where units of 4 tiles may be alike.

/// Lightness in 16ths of a unit, its mean removed.
struct Sample {
    std::int32_t side = 0;
    std::vector<std::int16_t> lightness;
    std::int16_t mean = 0;
};

/// Every `stride`-th texel each way of a square of `level` around the origin.
Result<Sample> take_sample(const ExchangeTexture& texture, int level, std::int32_t side, std::int32_t stride,
                           const ProgressPart& progress) {
    Sample sample{side, {}, 0};
    sample.lightness.reserve(std::size_t(side) * std::size_t(side));
    const std::int64_t first = -std::int64_t{side} * stride / 2;
    // Texels apart are rows apart too: then strips are single rows, in pieces that one evaluation may have
    const std::int32_t rows = stride == 1 ? strip_rows : 1;
    const std::int32_t piece = std::min(side * stride, 4096);
    Rgba8Image texels;
    std::int64_t sum = 0;
    for (std::int32_t y = 0; y < side; y += rows) {
        progress.advance(double(y) / side);
        for (std::int32_t x = 0; x < side * stride; x += piece) {
            const TexelRegion region{static_cast<std::uint8_t>(level), first + x,
                                     first + std::int64_t{y} * stride, piece, rows};
            if (auto done = texture.evaluate(region, progress.budget(), texels); !done) return done.error();
            for (std::int32_t v = 0; v < rows; ++v)
                for (std::int32_t u = 0; u < piece; u += stride) {
                    const float lightness = lightness_of(texels.row(v) + std::ptrdiff_t{4} * u);
                    sample.lightness.push_back(static_cast<std::int16_t>(lightness * 16 + 0.5F));
                    sum += sample.lightness.back();
                }
        }
    }
    sample.mean = static_cast<std::int16_t>(sum / std::ssize(sample.lightness));
    for (auto& value : sample.lightness) value = static_cast<std::int16_t>(value - sample.mean);
    return sample;
}

/// The mean product of the sample and itself, shifted. Shifts are less than its side.
double correlate(const Sample& sample, std::int32_t dx, std::int32_t dy) {
    const std::int32_t first = std::max(0, -dx), last = sample.side - std::max(0, dx);
    std::int64_t sum = 0;
    for (std::int32_t y = 0; y + dy < sample.side; ++y) {
        const std::int16_t* here = sample.lightness.data() + std::ptrdiff_t{y} * sample.side;
        const std::int16_t* there = here + std::ptrdiff_t{dy} * sample.side + dx;
        // So many products of at most 1600² stay below 2^31
        for (std::int32_t begin = first; begin < last; begin += 512) {
            std::int32_t part = 0;
            for (std::int32_t x = begin; x < std::min(begin + 512, last); ++x) part += here[x] * there[x];
            sum += part;
        }
    }
    return double(sum) / (double(last - first) * double(sample.side - dy));
}

Repetition::Level repetition_of(const Sample& sample, int level, std::int32_t period) {
    Repetition::Level out;
    out.level = level;
    const double variance = correlate(sample, 0, 0);
    // A texture of one colour repeats, whatever the shift
    const auto value = [&](std::int32_t dx, std::int32_t dy) {
        return variance > 0 ? correlate(sample, dx, dy) / variance : 1.0;
    };
    out.greatest.value = out.elsewhere = -1;
    for (std::int32_t y = 0; y <= farthest; ++y)
        for (std::int32_t x = -farthest; x <= farthest; ++x) {
            if (y == 0 && x <= 0) continue;
            out.shifts.push_back({double(x), double(y), value(x * period, y * period)});
            if (out.shifts.back().value > out.greatest.value) out.greatest = out.shifts.back();
            out.mean += out.shifts.back().value;
            if (period < 2) continue;
            out.elsewhere = std::max(out.elsewhere, value(x * period - period / 2, y * period + period / 2));
        }
    out.mean /= double(out.shifts.size());
    return out;
}

std::optional<Repetition::Shift> greatest_farther(const Sample& sample, std::int32_t period) {
    const std::int32_t last = std::min(farther, sample.side / 2 / period);
    const double variance = correlate(sample, 0, 0);
    std::optional<Repetition::Shift> greatest;
    for (std::int32_t y = 0; y <= last; ++y)
        for (std::int32_t x = -last; x <= last; ++x) {
            if ((y == 0 && x <= 0) || std::max(std::abs(x), y) <= farthest) continue;
            const double value = variance > 0 ? correlate(sample, x * period, y * period) / variance : 1.0;
            if (!greatest || value > greatest->value) greatest = {double(x), double(y), value};
        }
    return greatest;
}

/// The mean over all tiles, which fill the sample.
std::vector<float> mean_tile(const Sample& sample, std::int32_t period) {
    std::vector<std::int32_t> sums(std::size_t(period) * std::size_t(period));
    for (std::int32_t y = 0; y < sample.side; ++y)
        for (std::int32_t x = 0; x < sample.side; ++x)
            sums[std::size_t(y % period) * std::size_t(period) + std::size_t(x % period)] +=
                sample.lightness[std::size_t(y) * std::size_t(sample.side) + std::size_t(x)];
    const std::int32_t tiles = sample.side / period * (sample.side / period);
    std::vector<float> means;
    means.reserve(sums.size());
    for (const std::int32_t sum : sums)
        means.push_back((float(sum) / float(tiles) + float(sample.mean)) / 16);
    return means;
}

}  // namespace

Result<Repetition> measure_repetition(const ExchangeTexture& texture, std::int32_t tile_side,
                                      const ProgressPart& progress) {
    Repetition repetition;
    // 8×8 tiles at least
    const std::int32_t stride = std::max(1, tile_side * 8 / sample_side);
    const auto fine = take_sample(texture, 0, sample_side, stride, progress.part(0, 0.7));
    if (!fine) return fine.error();
    repetition.levels.push_back(repetition_of(*fine, 0, tile_side / stride));
    repetition.levels.back().farther = greatest_farther(*fine, tile_side / stride);
    repetition.mean_side = tile_side / stride;
    repetition.mean_lightness = mean_tile(*fine, repetition.mean_side);
    for (const int level : {4, 5}) {
        const std::int32_t period = tile_side >> level;
        if (period < 1 || period * (farthest + 1) >= coarse_sample_side) continue;
        const auto coarse = take_sample(texture, level, coarse_sample_side, 1,
                                        progress.part(level == 4 ? 0.8 : 0.9, level == 4 ? 0.9 : 1));
        if (!coarse) return coarse.error();
        repetition.levels.push_back(repetition_of(*coarse, level, period));
    }
    progress.advance(1);
    return repetition;
}

}  // namespace tessera
