#include "server/pattern/measured_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/pattern/descent.h"
#include "server/pattern/halved.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// A block is of 4^this cells: so few neighbours that what hangs over its borders hardly counts.
constexpr int block_cells_log2 = 2;
/// Texels of level 0 that are composited, all blocks together: one or two seconds.
constexpr std::uint64_t sampled_texels = std::uint64_t{1} << 26;
constexpr int fewest_places = 64, most_places = 1024;
/// Whole periods, but of no more than 4^most cells, are held against compositions of single cells.
constexpr int least_period_log2 = 4, most_period_log2 = 7;
constexpr int period_places = 64;

/// 6.5, and a fourth more, since what hangs over a block's border moves two of them.
constexpr double deviations = 8.125;
constexpr double mean_deviations = 4, worst_seen = 1.5;

}  // namespace

MeasuredError::MeasuredError(const Composite& composite, const DrawLaw& law)
    : composite_{composite}, law_{law} {
    blocks_.top = std::min(law.cell_log2 + block_cells_log2, int{max_level});
    const std::uint64_t texels = std::uint64_t{1} << std::min(2 * blocks_.top, 40);
    blocks_.places = static_cast<int>(std::min<std::uint64_t>(sampled_texels / texels, most_places));
    periods_.base = law.cell_log2;
    periods_.top = std::min({std::max(law.period_log2, law.cell_log2 + least_period_log2),
                             law.cell_log2 + most_period_log2, int{max_level}});
    periods_.places = period_places;
    for (Stage* stage : {&blocks_, &periods_}) {
        stage->paired = law.period_log2 > stage->top;
        const auto levels = static_cast<std::size_t>(stage->top - stage->base);
        stage->moments.resize(levels * levels);
    }
}

/// What compositions miss in the block (x, y) of the stage's top level: of each pair of levels, in the order
/// of Stage::moments, in codes.
Result<std::vector<LinearImage>> MeasuredError::errors_at(const Stage& stage, std::int64_t x, std::int64_t y,
                                                          const Budget& budget) const {
    Budget exact = budget;
    exact.accuracy = Accuracy::exact;
    const int levels = stage.top - stage.base;
    std::vector<LinearImage> right(static_cast<std::size_t>(levels) + 1), errors(stage.moments.size());
    std::vector<float> bounds;
    for (int composed = 0; composed <= levels; ++composed) {
        const std::int32_t side = std::int32_t{1} << (levels - composed);
        const TexelRegion region{
            static_cast<std::uint8_t>(stage.base + composed), x * side, y * side, side, side, 0};
        LinearImage image;
        if (const auto one = composite_.compose(region, exact, image, bounds); !one) return one.error();
        for (int level = composed; level <= levels; ++level) {
            if (level > composed) image = halved(image);
            if (composed == 0) {
                right[static_cast<std::size_t>(level)] = image;
                continue;
            }
            LinearImage& error = errors[static_cast<std::size_t>((level - 1) * levels + composed - 1)];
            error = image;
            const LinearImage& of = right[static_cast<std::size_t>(level)];
            for (std::size_t i = 0; i < of.values.size(); ++i)
                error.values[i] = (error.values[i] - of.values[i]) * 255;
        }
    }
    return errors;
}

Result<void> MeasuredError::measure(Stage& stage, const Budget& budget) const {
    const std::uint64_t key = stream("measured error", static_cast<std::uint64_t>(stage.base));
    constexpr std::int64_t blocks = std::int64_t{1} << 20;
    for (; stage.done < stage.places; ++stage.done) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        std::array<std::vector<LinearImage>, 2> errors;
        for (int sample = 0; sample < (stage.paired ? 2 : 1); ++sample) {
            std::array<std::int64_t, 2> at{};
            for (int axis = 0; axis < 2; ++axis) {
                const std::uint64_t bits = hash(0, key, stage.done, axis);
                at[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(bits % (2 * blocks)) - blocks;
                if (sample == 1)
                    at[static_cast<std::size_t>(axis)] += static_cast<std::int64_t>(1 + (bits >> 40) % 512)
                                                          << (law_.period_log2 - stage.top);
            }
            auto found = errors_at(stage, at[0], at[1], budget);
            if (!found) return found.error();
            errors[static_cast<std::size_t>(sample)] = std::move(*found);
        }
        for (std::size_t k = 0; k < stage.moments.size(); ++k) {
            Moments& moments = stage.moments[k];
            for (const auto& found : errors) {
                if (found.empty()) continue;
                for (std::size_t i = 0; i < found[k].values.size(); ++i) {
                    const double error = double{found[k].values[i]};
                    moments.sum[i % 4] += error;
                    moments.squares[i % 4] += error * error;
                    moments.least[i % 4] = std::min(moments.least[i % 4], error);
                    moments.most[i % 4] = std::max(moments.most[i % 4], error);
                }
                moments.count += found[k].values.size() / 4;
            }
            if (errors[1].empty()) continue;
            for (std::size_t i = 0; i < errors[0][k].values.size(); ++i)
                moments.pairs[i % 4] += double{errors[0][k].values[i]} * double{errors[1][k].values[i]};
            moments.pair_count += errors[0][k].values.size() / 4;
        }
    }
    return {};
}

MeasuredError::Spread MeasuredError::spread(Stage& stage, int level, int composed,
                                            std::size_t channel) const noexcept {
    if (composed <= stage.base) return {};
    const int met = std::min(level, stage.top), at = std::min(composed, stage.top);
    const auto variance_of = [&](const Moments& moments) {
        const auto count = static_cast<double>(moments.count);
        const double mean = moments.sum[channel] / count;
        return std::max(0.0, moments.squares[channel] / count - mean * mean);
    };
    const Moments& moments = stage.of(met, at);
    const double mean = moments.sum[channel] / static_cast<double>(moments.count);
    const double samples = stage.places * (stage.paired ? 2.0 : 1.0);
    Spread spread{mean, variance_of(stage.of(stage.top, at)) / samples, 0};
    double variance = variance_of(moments);
    if (level <= stage.top) {
        spread.reach = worst_seen * std::max(moments.most[channel] - mean, mean - moments.least[channel]);
    } else {
        double of_place = 0;
        if (stage.paired && level < law_.period_log2)
            of_place =
                std::clamp(moments.pairs[channel] / static_cast<double>(moments.pair_count) - mean * mean,
                           0.0, variance);
        variance = of_place + (variance - of_place) * std::ldexp(1.0, 2 * (stage.top - level));
    }
    spread.reach = std::max(spread.reach, deviations * std::sqrt(variance));
    return spread;
}

Result<double> MeasuredError::codes(int level, int depth, const Budget& budget) const {
    const int composed = level - depth;
    if (composed <= 0) return 0.0;
    if (blocks_.places < fewest_places) return std::numeric_limits<double>::infinity();
    const std::lock_guard lock{mutex_};
    if (auto measured = measure(blocks_, budget); !measured) return measured.error();
    if (composed > periods_.base)
        if (auto measured = measure(periods_, budget); !measured) return measured.error();
    double by_blocks = 0, by_both = 0;
    for (std::size_t c = 0; c < 4; ++c) {
        const auto total = [](const Spread& a, const Spread& b) {
            return std::abs(a.mean + b.mean) + mean_deviations * std::sqrt(a.doubt + b.doubt) + a.reach +
                   b.reach;
        };
        by_blocks = std::max(by_blocks, total(spread(blocks_, level, composed, c), {}));
        if (composed > periods_.base)
            by_both = std::max(by_both, total(spread(blocks_, level, periods_.base, c),
                                              spread(periods_, level, composed, c)));
    }
    if (composed <= periods_.base) return by_blocks;
    return composed <= blocks_.top ? std::min(by_blocks, by_both) : by_both;
}

}  // namespace tessera
