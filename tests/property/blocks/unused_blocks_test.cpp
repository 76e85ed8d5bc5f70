// What does not reach the output costs nothing: counted in instructions, one by one, and not timed.
#include <csignal>
#include <functional>

#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

/// Instructions that `work` takes in a process of its own, which is walked step by step. −1: not allowed
/// here.
std::int64_t instructions(const std::function<void()>& work) {
    const pid_t child = fork();
    if (child == 0) {
        if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
        raise(SIGSTOP);
        work();
        raise(SIGSTOP);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFSTOPPED(status)) return -1;
    std::int64_t count = 0;
    for (;; ++count) {
        if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) return -1;
        waitpid(child, &status, 0);
        if (!WIFSTOPPED(status)) return -1;
        if (WSTOPSIG(status) == SIGSTOP) break;
    }
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    return count;
}

std::string combinations() {
    std::string text;
    for (int i = 0; i < 16; ++i)
        text += std::string{i == 0 ? "" : ","} + R"({"corners": [)" + std::to_string(i & 1) + "," +
                std::to_string(i >> 1 & 1) + "," + std::to_string(i >> 2 & 1) + "," +
                std::to_string(i >> 3 & 1) + R"(], "patterns": {"entries": [{"pattern": )" +
                std::to_string(i) + "}]}}";
    return text;
}

const std::string scene = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
  {"name": "areas", "dithered_areas_map": {"areas": {"grid": "grid", "values": [0, 1, 1, 0], "width": 2, "cells": 32}}},
  {"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 2}},
  {"name": "x", "transition_tiles": {"families": 2, "material": {"block": "areas"}, "index": {"block": "draw"},
    "combinations": [%]}},
  {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})";

TEST(UnusedBlocks, TakeNoInstruction) {
    std::string alone = scene;
    alone.replace(alone.find('%'), 1, combinations());
    for (int at = 0;
         (at = static_cast<int>(alone.find("{\"pattern\": ", static_cast<std::size_t>(at)))) >= 0;) {
        // Two entries a combination, so that there is something to draw
        alone.insert(static_cast<std::size_t>(at), "{\"pattern\": 0}, ");
        at += 30;
    }
    std::string more = alone;
    for (int i = 0; i < 10; ++i) {
        const std::string n = std::to_string(i);
        more += R"(, {"name": "draw)" + n + R"(", "virtual_indirection_map": {"grid": "grid", "count": 5}},
          {"name": "t)" +
                n +
                R"(", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "draw)" +
                n + R"("}}})";
    }
    const auto a = plan_of(alone, R"("output": "t")"), b = plan_of(more, R"("output": "t")");
    ASSERT_TRUE(a) << a.error().detail;
    ASSERT_TRUE(b) << b.error().detail;
    std::vector<std::int32_t> out(64);
    const auto counted = [&](const Plan& plan) {
        const CellProgram& program = *reference_of(plan).program;
        const CellRow row{.x = 20, .y = 13, .count = 64};
        program.patterns({.x = 20, .y = 5, .count = 64},
                         out.data());  // A thread's rows are there from now on
        return instructions([&] { program.patterns(row, out.data()); });
    };
    const std::int64_t first = counted(*a), second = counted(*b);
    if (first < 0) GTEST_SKIP() << "NOT COUNTED: stepping through a process of one's own is not allowed here";
    EXPECT_EQ(first, second);
    EXPECT_GT(first, 500);
    EXPECT_LT(first, 50000) << "of 64 cells";
}

}  // namespace
}  // namespace tessera
