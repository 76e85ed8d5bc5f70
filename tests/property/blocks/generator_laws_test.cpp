// How random each generator is. The same measures are taken of all: `independent` passes them, `nested` and
// `typed` are even where they promise it, and the paper's sigma series fails where server/blocks/README.md
// says.
#include <cmath>
#include <functional>
#include <set>

#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

constexpr std::int32_t kinds = 16;  // Patterns that are drawn

/// A texture whose index is block "x".
struct Cells {
    Plan plan;
    const CellProgram* program = nullptr;

    explicit Cells(const std::string& blocks, std::uint64_t seed = 1) {
        auto compiled =
            plan_of(R"({"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8, "count": 65536}},
            {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},)" +
                        blocks + R"(, {"name": "t", "reference_texture":
            {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})",
                    "\"seed\": \"" + std::to_string(seed) + "\"");
        EXPECT_TRUE(compiled) << compiled.error().detail;
        plan = std::move(*compiled);
        program = reference_of(plan).program.get();
    }
    static Cells drawn(const std::string& generator, std::uint64_t seed = 1, std::int32_t count = kinds,
                       int stream = 0) {
        return Cells{R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": )" +
                         std::to_string(count) + R"(, "stream": )" + std::to_string(stream) +
                         R"(, "generator": ")" + generator + "\"}}",
                     seed};
    }

    std::vector<std::int32_t> rectangle(std::int64_t x, std::int64_t y, std::int32_t width,
                                        std::int32_t height) const {
        std::vector<std::int32_t> all(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        TypeGrid types;
        if (program->needs_types())
            types = reference_of(plan).grid.quadtree->types_of(0, x, y, width, height);
        for (std::int32_t j = 0; j < height; ++j)
            program->patterns({.x = x,
                               .y = y + j,
                               .count = width,
                               .types = program->needs_types() ? types.row(y + j) + (x - types.x) : nullptr},
                              all.data() + std::ptrdiff_t{j} * width);
        return all;
    }
};

/// How far χ² is from its mean, in standard deviations: of counts against shares.
double chi_square(const std::vector<double>& counts, const std::vector<double>& shares) {
    double total = 0, sum = 0;
    for (const double count : counts) total += count;
    for (std::size_t i = 0; i < counts.size(); ++i)
        sum += (counts[i] - total * shares[i]) * (counts[i] - total * shares[i]) / (total * shares[i]);
    const auto freedom = static_cast<double>(counts.size() - 1);
    return (sum - freedom) / std::sqrt(2 * freedom);
}

/// The same of pairs of draws against independence: counts[a·kinds + b].
double pair_dependence(std::size_t count,
                       const std::function<std::pair<std::int32_t, std::int32_t>(std::size_t)>& pair) {
    std::vector<double> counts(kinds * kinds, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [a, b] = pair(i);
        counts[static_cast<std::size_t>(a * kinds + b)] += 1;
    }
    return chi_square(counts, std::vector<double>(kinds * kinds, 1.0 / (kinds * kinds)));
}

/// The least shift by which the first 64 draws come again; 0 if none does.
std::size_t period(const std::vector<std::int32_t>& draws) {
    constexpr std::size_t window = 64;
    for (std::size_t p = 1; p + window <= draws.size(); ++p)
        if (std::equal(draws.begin(), draws.begin() + window, draws.begin() + static_cast<std::ptrdiff_t>(p)))
            return p;
    return 0;
}

std::vector<double> counts_of(const std::vector<std::int32_t>& draws, std::size_t size = kinds) {
    std::vector<double> counts(size, 0.0);
    for (const std::int32_t draw : draws) counts[static_cast<std::size_t>(draw)] += 1;
    return counts;
}

const std::vector<double> even(kinds, 1.0 / kinds);

/// Dependence between cells and their neighbours at (dx, dy), within a square.
double neighbour_dependence(const Cells& cells, std::int32_t dx, std::int32_t dy) {
    constexpr std::int32_t side = 700;
    const auto here = cells.rectangle(-300, 5000, side, side),
               there = cells.rectangle(-300 + dx, 5000 + dy, side, side);
    return pair_dependence(here.size(), [&](std::size_t i) { return std::pair{here[i], there[i]}; });
}

TEST(Independent, ShowsEachEntryOfAProbabilityMapAsOftenAsItsShare) {
    const int weights[] = {1, 2, 3, 5, 8, 13, 0, 32};
    std::string entries;
    std::vector<double> shares;
    for (int i = 0; i < 8; ++i) {
        entries += std::string{i == 0 ? "" : ","} + R"({"pattern": )" + std::to_string(i) +
                   R"(, "weight": )" + std::to_string(weights[i]) + "}";
        if (weights[i] != 0) shares.push_back(weights[i] / 64.0);
    }
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        for (const int draws : {64, 65536}) {
            const Cells cells{
                R"({"name": "draw", "virtual_indirection_map": {"grid": "grid", "generator": "independent", "count": )" +
                    std::to_string(draws) +
                    R"(}}, {"name": "x", "probability_map": {"index": {"block": "draw"},
                 "material": {"entries": [)" +
                    entries + "]}}}",
                seed};
            for (const std::int64_t corner :
                 {std::int64_t{0}, std::int64_t{-1} << 39, std::int64_t{65536 - 500}}) {
                auto counts = counts_of(cells.rectangle(corner, -corner, 1000, 1000), 8);
                ASSERT_EQ(counts[6], 0);
                counts.erase(counts.begin() + 6);
                EXPECT_LT(std::abs(chi_square(counts, shares)), 4.5) << seed << " " << draws << " " << corner;
            }
        }
    }
}

TEST(Independent, DrawsCountsThatAreNoPowersOfTwoEvenly) {
    for (const std::int32_t count : {3, 7, 100, 1000, 49152}) {
        const auto counts = counts_of(Cells::drawn("independent", 4, count).rectangle(0, 0, 2048, 1024),
                                      static_cast<std::size_t>(count));
        EXPECT_LT(
            std::abs(chi_square(counts, std::vector<double>(static_cast<std::size_t>(count), 1.0 / count))),
            4.5)
            << count;
    }
}

TEST(Independent, HasNoPeriodUpTo2To20CellsInEitherDirection) {
    constexpr std::int32_t length = (1 << 20) + 64;
    for (const std::int64_t from : {std::int64_t{0}, std::int64_t{-1234567}}) {
        const Cells cells = Cells::drawn("independent");
        EXPECT_EQ(period(cells.rectangle(from, from, length, 1)), 0u);
        EXPECT_EQ(period(cells.rectangle(from, from, 1, length)), 0u);
    }
}

TEST(Independent, ShowsNoShiftMoreAlikeThanChance) {
    // Whole rows against themselves shifted, by all powers of two and what lies about them
    const auto row = Cells::drawn("independent").rectangle(0, 9, 1 << 20, 1);
    const auto column = Cells::drawn("independent").rectangle(9, 0, 1, 1 << 20);
    for (const auto& draws : {row, column}) {
        for (std::size_t power = 1; power <= draws.size() / 2; power *= 2)
            for (const std::size_t shift : {power, power + 1, 3 * power / 2}) {
                const std::size_t count = draws.size() - shift;
                double same = 0;
                for (std::size_t i = 0; i < count; ++i) same += draws[i] == draws[i + shift];
                const double chance = 1.0 / kinds, cells = static_cast<double>(count);
                EXPECT_LT(std::abs(same / cells - chance), 4.8 * std::sqrt(chance * (1 - chance) / cells))
                    << shift;
            }
    }
}

TEST(Independent, RowsAreNotEachOtherShifted) {
    const Cells cells = Cells::drawn("independent");
    const auto rows = cells.rectangle(0, 0, 4096, 64);
    double worst = 0;
    for (std::size_t row = 1; row < 64; ++row)
        for (std::size_t shift = 0; shift < 256; ++shift) {
            double same = 0;
            for (std::size_t i = 0; i < 4096 - 256; ++i)
                same += rows[i + 128] == rows[row * 4096 + i + shift];
            worst = std::max(worst, same / (4096 - 256));
        }
    EXPECT_LT(worst, 1.0 / kinds + 5.5 * std::sqrt(1.0 / kinds / (4096 - 256)));
}

TEST(Independent, NeighboursTellNothingOfEachOther) {
    const Cells cells = Cells::drawn("independent");
    for (const auto& [dx, dy] :
         {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 0}, {0, 2}, {16, 0}, {0, 16}, {256, 0}, {0, 256}})
        EXPECT_LT(std::abs(neighbour_dependence(cells, dx, dy)), 4.5) << dx << " " << dy;
}

TEST(Independent, StreamsAndXAndYTellNothingOfEachOther) {
    const Cells cells = Cells::drawn("independent"), other = Cells::drawn("independent", 1, kinds, 7);
    constexpr std::int32_t side = 1000;
    const auto here = cells.rectangle(0, 0, side, side), there = other.rectangle(0, 0, side, side);
    EXPECT_LT(std::abs(pair_dependence(here.size(),
                                       [&](std::size_t i) {
                                           return std::pair{here[i], there[i]};
                                       })),
              4.5);
    EXPECT_LT(std::abs(pair_dependence(here.size() - side,
                                       [&](std::size_t i) {
                                           const std::size_t x = i % side, y = i / side;
                                           return x == y ? std::pair{here[i], here[i + side]}
                                                         : std::pair{here[y * side + x], here[x * side + y]};
                                       })),
              60)
        << "pairs (x, y), (y, x) are counted twice, so that χ² is up to twice its mean";
    const auto next_seed = Cells::drawn("independent", 2).rectangle(0, 0, side, side);
    EXPECT_LT(std::abs(pair_dependence(here.size(),
                                       [&](std::size_t i) {
                                           return std::pair{here[i], next_seed[i]};
                                       })),
              4.5);
}

TEST(Nested, DrawsEachAlternativeOnceInEveryAlignedBlock) {
    for (int j = 1; j <= 4; ++j) {
        const std::int32_t side = 1 << j;
        const Cells cells = Cells::drawn("nested", 5, side * side);
        for (int block = 0; block < 200; ++block) {
            const auto draws = cells.rectangle(std::int64_t{side} * (block * 7919 - 555),
                                               std::int64_t{side} * (block * 104729 - 9999), side, side);
            ASSERT_EQ(std::set<std::int32_t>(draws.begin(), draws.end()).size(), draws.size()) << j;
        }
    }
}

TEST(Nested, IsEvenOverAllAndHasNoPeriod) {
    const Cells cells = Cells::drawn("nested");
    const auto counts = counts_of(cells.rectangle(0, 0, 512, 512));
    EXPECT_THAT(counts, testing::Each(512.0 * 512 / kinds));
    EXPECT_EQ(period(cells.rectangle(0, 3, (1 << 18) + 64, 1)), 0u);
}

TEST(Typed, PatternsEqualAWalkFromTheRoots) {
    const Cells cells = Cells::drawn("typed");
    const TypedQuadtree& tree = *reference_of(cells.plan).grid.quadtree;
    for (const std::int64_t corner : {std::int64_t{0}, std::int64_t{-77}, std::int64_t{1} << 37}) {
        constexpr std::int32_t side = 48;
        const auto patterns = cells.rectangle(corner, -corner, side, side);
        for (std::int32_t i = 0; i < side * side; ++i) {
            const std::int64_t x = corner + i % side, y = -corner + i / side;
            constexpr int top = TypedQuadtree::root_height;
            const TypeGrid root = tree.types_of(top, x >> top, y >> top, 1, 1);
            std::uint16_t type = root.at(x >> top, y >> top);
            for (int height = top; height > 0; --height)
                type = tree.children(
                    height,
                    type)[static_cast<std::size_t>((x >> (height - 1) & 1) | (y >> (height - 1) & 1) << 1)];
            ASSERT_EQ(patterns[static_cast<std::size_t>(i)], cells.program->look_of_type(type).pattern);
        }
    }
}

TEST(Typed, RepeatsNoBlockInAWindowMoreOftenThanItsTypesDoByChance) {
    // A node of the quadtree is one of T types, and types of nodes are as good as drawn: of two nodes, one in
    // T pairs is alike; shifted by 2^k nodes, k + 1 in T, since they are alike too where ancestors are.
    const Cells cells = Cells::drawn("typed");
    const TypedQuadtree& tree = *reference_of(cells.plan).grid.quadtree;
    constexpr double types = 4096;
    for (int height = 0; height <= 3; ++height) {
        const std::int32_t side = 1024;
        const TypeGrid grid = tree.types_of(height, 0, 0, side, side);
        for (int k = 0; k <= 5; ++k) {
            for (const bool down : {false, true}) {
                const std::int64_t shift = std::int64_t{1} << k;
                double same = 0, pairs = 0;
                for (std::int64_t y = 0; y + (down ? shift : 0) < side; ++y)
                    for (std::int64_t x = 0; x + (down ? 0 : shift) < side; ++x, ++pairs)
                        same += grid.at(x, y) == (down ? grid.at(x, y + shift) : grid.at(x + shift, y));
                const double chance = (k + 1) / types;
                // Alike ancestors make whole blocks alike: their number, and not that of cells, sets the
                // spread
                const double spread = std::sqrt(chance / pairs) * static_cast<double>(shift);
                EXPECT_LT(same / pairs, chance + 4.5 * spread) << height << " " << k << " " << down;
            }
        }
    }
}

TEST(Typed, NeighboursTellNothingOfEachOther) {
    const Cells cells = Cells::drawn("typed");
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}}) {
        // T types make few distinct pairs, so that χ² spreads more than of free draws; as a correlation it is
        // nothing
        constexpr double pairs = 700.0 * 700.0;
        const double chi = neighbour_dependence(cells, dx, dy) * std::sqrt(2 * 255.0) + 255;
        EXPECT_LT(std::sqrt(chi / pairs / (kinds - 1)), 0.03) << dx << " " << dy;
    }
}

TEST(Sigma, ComesAgainAfterTheCubeOfItsTable) {
    const Cells cells = Cells::drawn("sigma");
    EXPECT_EQ(period(cells.rectangle(0, 0, 1 << 15, 1)), 4096u);
    EXPECT_EQ(period(cells.rectangle(0, 0, 1, 1 << 15)), 4096u);
}

TEST(Sigma, HasNoMoreRowsThanItsTableHasEntries) {
    const Cells cells = Cells::drawn("sigma");
    std::set<std::vector<std::int32_t>> rows;
    for (int y = 0; y < 2000; ++y) rows.insert(cells.rectangle(0, y, 256, 1));
    EXPECT_EQ(rows.size(), 16u);
}

TEST(Sigma, ShowsEachPatternOnceInEveryRunOfItsTablesSize) {
    const Cells cells = Cells::drawn("sigma");
    for (int run = 0; run < 100; ++run) {
        const auto draws = cells.rectangle(16 * run, 3, 16, 1);
        EXPECT_EQ(std::set<std::int32_t>(draws.begin(), draws.end()).size(), 16u);
    }
}

TEST(Sigma, FailsWhatIndependentPasses) {
    const Cells cells = Cells::drawn("sigma");
    EXPECT_LT(chi_square(counts_of(cells.rectangle(0, 0, 1024, 1000)), even), -2.7) << "far too even";
    EXPECT_GT(neighbour_dependence(cells, 1, 0), 1000) << "a cell tells of the next";
    EXPECT_GT(neighbour_dependence(cells, 16, 0), 100);
}

}  // namespace
}  // namespace tessera
