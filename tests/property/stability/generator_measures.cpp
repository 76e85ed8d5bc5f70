#include "tests/property/stability/generator_measures.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera::tests {
namespace {

constexpr std::int32_t side = 256;

/// Of the square from (at, at) on, one more on the right and below.
std::vector<std::int32_t> square(const CellGenerator& draw, std::int64_t at) {
    std::vector<std::int32_t> all;
    for (std::int32_t y = 0; y <= side; ++y)
        for (std::int32_t x = 0; x <= side; ++x) all.push_back(draw(at + x, at + y));
    return all;
}

/// χ² of counts that should be equal, in standard deviations from its mean.
double chi_square(const std::vector<double>& counts) {
    double total = 0, sum = 0;
    for (const double count : counts) total += count;
    const double expected = total / static_cast<double>(counts.size());
    for (const double count : counts) sum += (count - expected) * (count - expected) / expected;
    const auto freedom = static_cast<double>(counts.size() - 1);
    return (sum - freedom) / std::sqrt(2 * freedom);
}

template <class Real>
std::int32_t along(const std::vector<std::int32_t>& table, std::int64_t at, std::int32_t start) {
    const auto count = static_cast<Real>(table.size());
    auto rest = static_cast<Real>(at);
    std::int32_t s = start;
    for (int i = 0; i < 3; ++i) {
        const Real index = rest + static_cast<Real>(s);
        s = table[static_cast<std::size_t>(index - std::floor(index / count) * count)];
        rest = std::floor(rest / count);
    }
    return s;
}

}  // namespace

GeneratorMeasure measure(const CellGenerator& draw, std::int64_t at) {
    const std::vector<std::int32_t> here = square(draw, at), origin = square(draw, 0);
    std::vector<double> counts(draw_kinds), right(draw_kinds * draw_kinds), below(right.size());
    GeneratorMeasure measured;
    constexpr double share = 1.0 / (side * side);
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; ++x) {
            const std::size_t i = y * (side + 1) + x;
            const auto pair = [&](std::size_t j) {
                return static_cast<std::size_t>(here[i] * draw_kinds + here[j]);
            };
            ++counts[static_cast<std::size_t>(here[i])];
            ++right[pair(i + 1)];
            ++below[pair(i + side + 1)];
            if (here[i] == here[i + 1]) measured.alike_neighbours += share;
            if (here[i] == origin[i]) measured.alike_far += share;
        }
    measured.evenness = chi_square(counts);
    const double across = chi_square(right), down = chi_square(below);
    measured.dependence = std::abs(across) > std::abs(down) ? across : down;
    return measured;
}

bool looks_random(const GeneratorMeasure& measured, bool at_origin) {
    const double spread = std::sqrt(1.0 / draw_kinds / (side * side));
    return std::abs(measured.evenness) < 5 && std::abs(measured.dependence) < 5 &&
           std::abs(measured.alike_neighbours - 1.0 / draw_kinds) < 5 * spread &&
           (at_origin || std::abs(measured.alike_far - 1.0 / draw_kinds) < 5 * spread);
}

int breaks_at(const CellGenerator& draw, int max_log2,
              const std::function<bool(const GeneratorMeasure&)>& passes) {
    for (int k = 0; k <= max_log2; ++k)
        if (!passes(measure(draw, std::int64_t{1} << k))) return k;
    return -1;
}

template <class Real>
CellGenerator sigma_in(std::vector<std::int32_t> table) {
    return [table = std::move(table)](std::int64_t x, std::int64_t y) {
        return along<Real>(table, x, along<Real>(table, y, 0));
    };
}
template CellGenerator sigma_in<float>(std::vector<std::int32_t>);
template CellGenerator sigma_in<double>(std::vector<std::int32_t>);

template <class Real>
CellGenerator kolar_in(double alpha, double beta) {
    return [alpha, beta](std::int64_t a, std::int64_t b) {
        const auto x = static_cast<Real>(a), y = static_cast<Real>(b);
        const Real across = static_cast<Real>(alpha) + x + std::cos(y),
                   down = static_cast<Real>(beta) + y + std::sin(x);
        const Real sum = across * across + down * down;
        return std::min(draw_kinds - 1,
                        static_cast<std::int32_t>((sum - std::floor(sum)) * Real{draw_kinds}));
    };
}
template CellGenerator kolar_in<float>(double, double);
template CellGenerator kolar_in<double>(double, double);

}  // namespace tessera::tests
