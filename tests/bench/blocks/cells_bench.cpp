// What a cell costs to decide, by kind of pattern and length of row: per cell, times in nanoseconds.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "shared/math/hash.h"
#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

std::string combinations() {
    std::string text;
    for (int i = 0; i < 16; ++i)
        text += std::string{i == 0 ? "" : ","} + R"({"corners": [)" + std::to_string(i & 1) + "," +
                std::to_string(i >> 1 & 1) + "," + std::to_string(i >> 2 & 1) + "," +
                std::to_string(i >> 3 & 1) + R"(], "patterns": {"entries": [{"pattern": )" +
                std::to_string(i) + R"(}, {"pattern": 3}]}})";
    return text;
}

const std::string ground = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 1}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 1}},)";
const std::string shown =
    R"(, {"name": "texture", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "last"}}})";

std::string indirection(const char* name, const char* generator) {
    return std::string{R"({"name": ")"} + name +
           R"(", "virtual_indirection_map": {"grid": "grid", "count": 16, "generator": ")" + generator +
           "\"}}";
}

/// Four of eight entries alike, as a painted map is: half of what lies between nodes needs no draw.
std::string dithered(const char* name, int cells) {
    return std::string{R"({"name": ")"} + name +
           R"(", "dithered_areas_map": {"areas": {"grid": "grid", "width": 4, "values": [0,1,0,1, 1,0,1,0], "cells": )" +
           std::to_string(cells) + "}}}";
}

std::string transitions(int cells) {
    return ground + dithered("areas", cells) + "," + indirection("index", "independent") +
           R"(, {"name": "last", "transition_tiles": {"families": 2, "material": {"block": "areas"},
               "index": {"block": "index"}, "combinations": [)" +
           combinations() + "]}}" + shown;
}

void decide(benchmark::State& state, const std::string& blocks) {
    const auto plan = plan_of(blocks);
    if (!plan) return state.SkipWithError(plan.error().detail.c_str());
    const CellProgram& program = *reference_of(*plan).program;
    const auto count = static_cast<std::int32_t>(state.range(0));
    std::vector<std::int32_t> out(static_cast<std::size_t>(count));
    std::vector<std::uint16_t> types(out.size());
    for (std::size_t i = 0; i < types.size(); ++i) types[i] = static_cast<std::uint16_t>(mix(i) % 4096);
    CellRow row{.x = 12345, .y = -77, .count = count, .types = types.data()};
    for (auto _ : state) {
        ++row.y;
        program.patterns(row, out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.counters["per_cell"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * count,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void rows(benchmark::internal::Benchmark* bench) { bench->ArgName("cells")->Arg(256)->Arg(4096); }

BENCHMARK_CAPTURE(decide, typed, ground + indirection("last", "typed") + shown)->Apply(rows);
BENCHMARK_CAPTURE(decide, independent, ground + indirection("last", "independent") + shown)->Apply(rows);
BENCHMARK_CAPTURE(decide, nested, ground + indirection("last", "nested") + shown)->Apply(rows);
BENCHMARK_CAPTURE(decide, sigma, ground + indirection("last", "sigma") + shown)->Apply(rows);
BENCHMARK_CAPTURE(decide, dithered_8, ground + dithered("last", 8) + shown)->Apply(rows);
BENCHMARK_CAPTURE(decide, dithered_256, ground + dithered("last", 256) + shown)->Apply(rows);
BENCHMARK_CAPTURE(decide, transitions_8, transitions(8))->Apply(rows);
BENCHMARK_CAPTURE(decide, transitions_256, transitions(256))->Apply(rows);

}  // namespace
}  // namespace tessera
