#include "shared/motion/evenness.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tessera {

namespace {

bool is_consecutive(std::span<const WeightedPhase> phases) noexcept {
    for (std::size_t i = 1; i < phases.size(); ++i)
        if (phases[i].phase - 1 != phases[i - 1].phase || phases[i].weight != phases[0].weight) return false;
    return true;
}

/// Of a window of `length` steps of a cycle, where phases are `count` consecutive ones: they go round the
/// cycle some times and then cover a part of it, which meets the window more or less.
double uneven_window(double length, double cycle, double count) noexcept {
    const double rounds = std::floor(count / cycle), part = count - rounds * cycle;
    const double share = length / cycle;
    const double most = (rounds * length + std::min(length, part)) / count;
    const double least = (rounds * length + std::max(0.0, length + part - cycle)) / count;
    return std::max(most - share, share - least);
}

/// Of any window: the largest difference of phases counted and steps counted from the cycle's beginning on.
double uneven_windows(std::int64_t cycle, std::span<const WeightedPhase> phases) {
    std::vector<WeightedPhase> sorted(phases.begin(), phases.end());
    for (WeightedPhase& phase : sorted) phase.phase = (phase.phase % cycle + cycle) % cycle;
    std::sort(sorted.begin(), sorted.end(),
              [](const WeightedPhase& a, const WeightedPhase& b) { return a.phase < b.phase; });
    double counted = 0, least = 0, most = 0;
    const auto whole = static_cast<double>(cycle);
    for (const WeightedPhase& phase : sorted) {
        least = std::min(least, counted - static_cast<double>(phase.phase) / whole);
        counted += phase.weight;
        most = std::max(most, counted - static_cast<double>(phase.phase + 1) / whole);
    }
    return most - least;
}

}  // namespace

double uneven_frames(const TimeLine& line, std::int64_t rest, std::span<const WeightedPhase> phases) {
    if (rest >= endless_rest || line.frames() == 1) return 0;
    const std::int64_t cycle = rest + line.lead() + line.run();
    double sum = 0;
    if (is_consecutive(phases)) {
        const auto whole = static_cast<double>(cycle), count = static_cast<double>(phases.size());
        sum = uneven_window(static_cast<double>(line.run() - 1), whole, count);
        for (std::int32_t frame = 1; frame < line.frames() && sum < 2; ++frame)
            sum +=
                uneven_window(static_cast<double>(line.end_of(frame) - line.begin_of(frame)), whole, count);
    } else {
        sum = uneven_windows(cycle, phases) * line.frames();
    }
    return std::clamp(sum / 2, 0.0, 1.0);
}

}  // namespace tessera
