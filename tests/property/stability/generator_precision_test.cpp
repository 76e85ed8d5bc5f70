// How far from the origin each way to draw stays random, in the arithmetic that it is computed in: what
// tests/property/blocks/generator_laws_test.cpp measures near the origin, at coordinates up to 2^40.
// Coordinates are cells for the sigma series, and tiles for Kolář's formula.
#include <iomanip>
#include <iostream>
#include <numeric>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "server/blocks/sigma_series.h"
#include "server/texture/kolar_choice.h"
#include "shared/math/hash.h"
#include "tests/property/stability/generator_measures.h"

namespace tessera::tests {
namespace {

constexpr std::uint64_t seed = 5;
constexpr int far_log2 = 40;

std::int64_t coordinate(int log2) { return log2 < 0 ? 0 : std::int64_t{1} << log2; }
std::string name_of_coordinate(int log2) { return log2 < 0 ? "0" : "2^" + std::to_string(log2); }

/// At the coordinates that the issue of this names, a line each. −1 is the origin.
std::vector<std::pair<int, GeneratorMeasure>> printed(const std::string& name, const CellGenerator& draw) {
    std::vector<std::pair<int, GeneratorMeasure>> all;
    for (const int log2 : {-1, 16, 24, 32, far_log2}) {
        const GeneratorMeasure m = measure(draw, coordinate(log2));
        all.emplace_back(log2, m);
        std::cout << std::left << std::setw(16) << name << std::right << std::setw(5)
                  << name_of_coordinate(log2) << std::fixed << std::setprecision(1) << "  evenness "
                  << std::setw(8) << m.evenness << "  dependence " << std::setw(8) << m.dependence
                  << std::setprecision(4) << "  as its neighbour " << m.alike_neighbours
                  << "  as at the origin " << m.alike_far << '\n';
    }
    return all;
}

/// The same shuffle as SigmaSeries makes: a test holds the two equal.
std::vector<std::int32_t> sigma_table() {
    std::vector<std::int32_t> table(draw_kinds);
    std::iota(table.begin(), table.end(), 0);
    for (std::uint32_t i = draw_kinds - 1; i > 0; --i)
        std::swap(table[i], table[uniform_below(hash(seed, stream("sigma"), i, 0), i + 1)]);
    return table;
}
CellGenerator sigma_of_integers() {
    return [series = SigmaSeries{seed, stream("sigma"), draw_kinds}](std::int64_t x, std::int64_t y) {
        return series.at(x, y, 0);
    };
}
CellGenerator own_kolar(double alpha, double beta) {
    return [=](std::int64_t x, std::int64_t y) {
        return static_cast<std::int32_t>(kolar_draw(alpha, beta, x, y) * draw_kinds) % draw_kinds;
    };
}

/// The share of 256 × 256 draws from (at, at) on that differ.
double different(const CellGenerator& a, const CellGenerator& b, std::int64_t at) {
    int count = 0;
    for (std::int64_t y = 0; y < 256; ++y)
        for (std::int64_t x = 0; x < 256; ++x) count += a(at + x, at + y) != b(at + x, at + y);
    return count / 65536.0;
}

TEST(GeneratorPrecision, TheCounterHashIsAsRandomAnywhereAsAtTheOrigin) {
    const CellGenerator draw = [](std::int64_t x, std::int64_t y) {
        return static_cast<std::int32_t>(uniform_below(hash(seed, stream("draws"), x, y), draw_kinds));
    };
    for (const auto& [log2, m] : printed("counter hash", draw))
        EXPECT_TRUE(looks_random(m, log2 < 0)) << log2;
    for (int log2 = 0; log2 <= 62; ++log2)
        for (const std::int64_t sign : {1, -1})
            EXPECT_TRUE(looks_random(measure(draw, sign * coordinate(log2)), log2 < 8))
                << sign << " " << log2;
}

TEST(GeneratorPrecision, TheSigmaSeriesIsNoMoreRandomAtTheOriginAndComesAgainFromThereOn) {
    for (const auto& [log2, m] : printed("sigma integers", sigma_of_integers())) {
        EXPECT_GT(m.dependence, 1000) << "a cell tells of the next";
        EXPECT_LT(m.evenness, -2.7) << "each kind exactly as often";
        EXPECT_EQ(m.alike_far, 1) << "a multiple of 4096 cells away all is the same";
    }
}

TEST(GeneratorPrecision, TheSigmaSeriesInFloatsEndsWhereCellsHaveNoNumberOfTheirOwn) {
    const CellGenerator in_float = sigma_in<float>(sigma_table()),
                        in_double = sigma_in<double>(sigma_table()), exact = sigma_of_integers();
    const auto all_float = printed("sigma floats", in_float);
    printed("sigma doubles", in_double);
    int first_wrong = -1;
    for (int log2 = 0; log2 <= far_log2; ++log2) {
        EXPECT_EQ(different(in_double, exact, coordinate(log2)), 0) << log2;
        if (first_wrong < 0 && different(in_float, exact, coordinate(log2)) > 0) first_wrong = log2;
    }
    std::cout << "sigma in floats is another series from 2^" << first_wrong
              << " on; in doubles not up to 2^40\n";
    EXPECT_EQ(first_wrong, 24);
    EXPECT_GT(all_float[2].second.alike_neighbours, 0.5) << "2^24: every other cell is its neighbour";
    EXPECT_NEAR(all_float[3].second.alike_neighbours, 1, 1e-9) << "2^32: one cell for all";
    // 2^53, the same for doubles
    EXPECT_GT(measure(in_double, std::int64_t{1} << 53).alike_neighbours, 0.5);
}

TEST(GeneratorPrecision, KolarsFormulaBreaksAt2To9TilesInFloatsAnd2To24InDoubles) {
    const double alpha = 0.3, beta = 0.8;
    const auto random = [](const GeneratorMeasure& m) { return looks_random(m, true); };
    struct Way {
        const char* name;
        CellGenerator draw;
        int breaks;
    };
    for (const Way& way : {Way{"kolar floats", kolar_in<float>(alpha, beta), 9},
                           Way{"kolar doubles", kolar_in<double>(alpha, beta), 24},
                           Way{"kolar as ours", own_kolar(alpha, beta), 24}}) {
        const auto all = printed(way.name, way.draw);
        EXPECT_TRUE(looks_random(all[0].second, true)) << way.name;
        EXPECT_NEAR(all[3].second.alike_neighbours, 1, 1e-9)
            << way.name << ": at 2^32 all tiles draw the same";
        const int breaks = breaks_at(way.draw, far_log2, random);
        std::cout << way.name << " breaks at 2^" << breaks << " tiles\n";
        EXPECT_EQ(breaks, way.breaks) << way.name;
    }
    // Each patch has parameters of its own: the formula breaks at the same place for all of them
    for (int patch = 0; patch < 8; ++patch) {
        const CellGenerator draw = own_kolar(patch / 8.0 + 0.01, 1 - patch / 9.0);
        EXPECT_TRUE(random(measure(draw, 0))) << patch;
        EXPECT_TRUE(random(measure(draw, std::int64_t{1} << 20))) << patch;
        EXPECT_FALSE(random(measure(draw, std::int64_t{1} << 24))) << patch;
    }
}

}  // namespace
}  // namespace tessera::tests
