// Pattern textures against a cold memcpy of a page, one core, and against the limits that they are held to.
//   build/release/bin/pattern_bench
// prints the median time of a page of codes at each level and its ratio to the memcpy of the same run, and
// what the extent and the number of patterns cost. Returns 1 if a limit is exceeded.
#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>
#include <functional>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include <google/protobuf/util/json_util.h>

#include "server/blocks/plan.h"
#include "server/pattern/cell_texture.h"
#include "shared/math/hash.h"
#include "tests/support/made_patterns.h"

namespace tessera {
namespace {

constexpr std::size_t page_bytes = 256 * 256 * 4;

/// Patterns and maps of random codes.
class MadeFiles final : public BlockFiles {
  public:
    Result<PatternImages> read_patterns(const std::string&, const proto::PatternSet& set) override {
        return made_patterns(static_cast<std::int32_t>(set.side_texels()),
                             static_cast<std::int32_t>(set.count()), 1, true);
    }
    Result<StoredMap> read_map(const std::string&, const std::string&) override {
        std::vector<std::int32_t> values;
        for (std::int64_t i = 0; i < 37 * 41; ++i)
            values.push_back(static_cast<std::int32_t>(hash(3, stream("map"), i, 0) % 2));
        return StoredMap{37, 41, values, StoredMap::Edge::wrap, 0, 0, 0};
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string&, const proto::Block&) override {
        return std::shared_ptr<const Texture>{};
    }
};

std::shared_ptr<const Texture> texture_of(const std::string& blocks) {
    proto::Pattern message;
    if (const auto status =
            google::protobuf::util::JsonStringToMessage("{\"blocks\": [" + blocks + "]}", &message);
        !status.ok()) {
        std::cerr << status.ToString() << "\n";
        std::exit(2);
    }
    MadeFiles files;
    const auto plan = compile_plan(message, files);
    if (!plan) {
        std::cerr << plan.error().detail << "\n";
        std::exit(2);
    }
    return make_cell_texture(std::get<ReferencePlan>(plan->textures.back().what));
}

std::string set_and_grid(int side, int count) {
    return R"({"name": "set", "patternSet": {"image": "p.png", "sideTexels": )" + std::to_string(side) +
           R"(, "count": )" + std::to_string(count) +
           R"(}}, {"name": "grid", "virtualTileMap": {"cellTexels": )" + std::to_string(side) + "}}, ";
}

/// Basic aperiodic tiling: section 4.
std::string aperiodic(int side, int count, const std::string& generator) {
    return set_and_grid(side, count) +
           R"({"name": "index", "virtualIndirectionMap": {"grid": "grid", "count": )" +
           std::to_string(count) + R"(, "generator": ")" + generator +
           R"("}}, {"name": "out", "referenceTexture": {"patterns": "set", "grid": "grid",
               "index": {"block": "index"}}})";
}

/// Extended aperiodic tiling: a dithered areas map of two families, transition tiles, two patterns for each
/// combination.
std::string transitions(int side) {
    std::string combinations;
    for (int i = 0; i < 16; ++i)
        combinations += std::string(i == 0 ? "" : ", ") + R"({"corners": [)" + std::to_string(i & 1) + ", " +
                        std::to_string(i >> 1 & 1) + ", " + std::to_string(i >> 2 & 1) + ", " +
                        std::to_string(i >> 3) + R"(], "patterns": {"entries": [{"pattern": )" +
                        std::to_string(2 * i) + R"(}, {"pattern": )" + std::to_string(2 * i + 1) + "}]}}";
    return set_and_grid(side, 32) +
           R"({"name": "material", "ditheredAreasMap": {"areas": {"grid": "grid", "image": "a.png", "cells": 16}}},
              {"name": "index", "virtualIndirectionMap": {"grid": "grid", "count": 2}},
              {"name": "tiles", "transitionTiles": {"material": {"block": "material"}, "index": {"block": "index"},
                  "families": 2, "combinations": [)" +
           combinations + R"(]}}, {"name": "out", "referenceTexture": {"patterns": "set", "grid": "grid",
               "index": {"block": "tiles"}}})";
}

/// Of this thread: others may use the machine.
double microseconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) / 1e3;
}

double median_time(int times, const std::function<void(int)>& run) {
    std::vector<double> spent;
    for (int i = 0; i < times; ++i) {
        const double start = microseconds();
        run(i);
        spent.push_back(microseconds() - start);
    }
    std::nth_element(spent.begin(), spent.begin() + times / 2, spent.end());
    return spent[static_cast<std::size_t>(times) / 2];
}

double cold_memcpy() {
    // 512 pages each way: far more than the caches hold, visited in an order that no prefetcher guesses
    constexpr std::size_t pages = 512;
    static std::vector<std::uint8_t> from(pages * page_bytes, 1), to(pages * page_bytes, 2);
    return median_time(501, [&](int i) {
        const std::size_t at = (static_cast<std::size_t>(i) * 389 % pages) * page_bytes;
        std::memcpy(to.data() + at, from.data() + at, page_bytes);
    });
}

/// Pages that no earlier one of the run shares cells with, inside an extent of 2^log2 texels.
double page_time(const Texture& texture, std::uint8_t level, int log2, int times,
                 Accuracy accuracy = Accuracy::high) {
    Rgba8Image page;
    const auto pages = std::uint32_t{1} << std::clamp(log2 - 8 - level, 0, 30);
    return median_time(times, [&](int i) {
        const auto at = [&](std::uint64_t axis) {
            return std::int64_t{uniform_below(hash(1, stream("bench page", axis), i, level), pages)} * 256;
        };
        if (!texture.evaluate({level, at(0), at(1), 256, 256, 0}, {.accuracy = accuracy}, page)) std::exit(2);
    });
}

int failures = 0;

void hold(const std::string& what, double ratio, double limit) {
    if (ratio <= limit) return;
    ++failures;
    std::cout << "EXCEEDED: " << what << " is " << ratio << ", at most " << limit << "\n";
}

/// Prints the levels from 0 on, and holds levels 0 to 6 to a limit.
void levels(const std::string& name, const Texture& texture, double limit, int last) {
    std::cout << "\n" << name << ": " << texture.description() << "\n";
    for (int level = 0; level <= last; ++level) {
        const bool limited = level <= 6;
        // Other people's work spoils some runs: the better of two, each beside its own memcpy
        double best = 1e9, time = 0, copy = 0;
        for (int run = 0; run < 3 && (run == 0 || (limited && best > limit)); ++run) {
            const double of_copy = cold_memcpy();
            const double of_page =
                page_time(texture, static_cast<std::uint8_t>(level), 38, limited ? 101 : 11);
            if (of_page / of_copy >= best) continue;
            best = of_page / of_copy;
            time = of_page;
            copy = of_copy;
        }
        std::cout << "  level " << std::setw(2) << level << std::fixed << std::setprecision(1) << std::setw(9)
                  << time << " us, memcpy " << copy << " us: " << std::setprecision(2) << best << " x\n";
        if (limited) hold(name + ", level " + std::to_string(level) + ", against a memcpy", best, limit);
    }
}

/// What dithering and transition tiles cost beside a basic tiling, at each level up to `last` and all of
/// levels 0 to 6 together: the paper's cost grew 22-fold.
void growth(const std::string& name, const Texture& basic, const Texture& extended, int last) {
    constexpr double limit = 3;
    double best = 1e9;
    std::array<double, 7> best_of_level;
    best_of_level.fill(1e9);
    for (int run = 0; run < 3; ++run) {
        double of_basic = 0, of_extended = 0;
        for (std::size_t level = 0; level < best_of_level.size(); ++level) {
            const double plain = page_time(basic, static_cast<std::uint8_t>(level), 38, 101);
            const double mixed = page_time(extended, static_cast<std::uint8_t>(level), 38, 101);
            best_of_level[level] = std::min(best_of_level[level], mixed / plain);
            of_basic += plain;
            of_extended += mixed;
        }
        best = std::min(best, of_extended / of_basic);
    }
    std::cout << "dithered areas and transition tiles cost " << best << " x " << name
              << ", levels 0 to 6 together; level by level";
    for (std::size_t level = 0; level < best_of_level.size(); ++level) {
        std::cout << " " << best_of_level[level];
        if (static_cast<int>(level) <= last)
            hold("growth from " + name + " at level " + std::to_string(level), best_of_level[level], limit);
    }
    std::cout << "\n";
    hold("growth from " + name, best, limit);
}

/// A page costs the same in any extent: a ratio of medians over levels.
void extents(const std::string& name, const Texture& texture) {
    double small = 0, large = 0;
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{4}}) {
        small += page_time(texture, level, 12, 201);
        large += page_time(texture, level, 38, 201);
    }
    std::cout << name << ": extent 2^38 costs " << large / small << " x that of 2^12\n";
    hold(name + ", extent 2^38 against 2^12", large / small, 1.5);
}

}  // namespace
}  // namespace tessera

int main() {
    using namespace tessera;
    const auto typed = texture_of(aperiodic(64, 16, "typed"));
    const auto independent = texture_of(aperiodic(64, 16, "independent"));
    const auto dithered = texture_of(transitions(64));
    levels("basic aperiodic tiling, typed", *typed, 3, 20);
    levels("basic aperiodic tiling, independent", *independent, 3, 12);
    levels("dithered areas and transition tiles", *dithered, 6, 12);
    std::cout << "\n";
    for (const std::uint8_t level : {std::uint8_t{10}, std::uint8_t{13}})
        std::cout << "exact, level " << int{level} << ": independent "
                  << page_time(*independent, level, 38, 1, Accuracy::exact) / 1e3 << " ms, dithered areas "
                  << page_time(*dithered, level, 38, 1, Accuracy::exact) / 1e3 << " ms\n";
    std::cout << "\n";
    growth("a basic tiling of the same generator", *independent, *dithered, 6);
    growth("a typed basic tiling", *typed, *dithered, 5);  // At level 6 a typed texel is a look-up, no draw
    extents("typed", *typed);
    extents("dithered", *dithered);

    // The number of patterns, as long as a texel is no larger than a cell
    double few = 0, many = 0;
    const auto texture_of_few = texture_of(aperiodic(16, 16, "typed"));
    const auto texture_of_many = texture_of(aperiodic(16, 1024, "typed"));
    for (std::uint8_t level = 0; level <= 4; ++level) {
        few += page_time(*texture_of_few, level, 38, 201);
        many += page_time(*texture_of_many, level, 38, 201);
    }
    std::cout << "1024 patterns of 16 texels cost " << many / few << " x 16 of them\n";
    hold("1024 patterns against 16", many / few, 1.5);
    std::cout << (failures == 0 ? "All limits hold.\n" : "Limits are exceeded.\n");
    return failures == 0 ? 0 : 1;
}
