// What a plan holds: what reaches the output, folded where it is constant, each block at its rate.
#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::string tiles = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
  {"name": "index", "virtual_indirection_map": {"grid": "grid", "count": 16}},
  {"name": "texture", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "index"}}})";

const PlanLine& line_of(const Plan& plan, const std::string& name) {
    for (const PlanLine& line : plan.lines)
        if (line.name == name) return line;
    ADD_FAILURE() << name;
    return plan.lines.front();
}

std::vector<std::int32_t> some_patterns(const ReferencePlan& reference) {
    std::vector<std::int32_t> patterns(5000);
    const std::vector<std::uint16_t> types =
        reference.grid.quadtree == nullptr ? std::vector<std::uint16_t>(5000)
                                           : reference.grid.quadtree->types_of(0, -2500, 77, 5000, 1).types;
    reference.program->patterns({.x = -2500, .y = 77, .count = 5000, .types = types.data()}, patterns.data());
    return patterns;
}

TEST(Plan, DropsWhatDoesNotReachTheOutputOnceItIsChecked) {
    std::string unused;
    for (int i = 0; i < 10; ++i) {
        const std::string n = std::to_string(i);
        unused += R"(, {"name": "set)" + n + R"(", "pattern_set": {"image": "other.png", "side_texels": 8}},
            {"name": "index)" +
                  n + R"(", "virtual_indirection_map": {"grid": "grid", "count": 7, "generator": "sigma"}},
            {"name": "layer)" +
                  n + R"(", "reference_texture": {"patterns": "set)" + n +
                  R"(", "grid": "grid", "index": {"block": "index)" + n + R"("}}})";
    }
    TestFiles alone_files, more_files;
    const auto alone = compile_plan(pattern_of(tiles), alone_files);
    const auto more = compile_plan(pattern_of(tiles + unused, R"("output": "texture")"), more_files);
    ASSERT_TRUE(alone && more);
    EXPECT_EQ(alone_files.reads, 1);
    EXPECT_EQ(more_files.reads, 11);
    ASSERT_EQ(alone->textures.size(), 1u);
    ASSERT_EQ(more->textures.size(), 1u);
    const ReferencePlan &a = reference_of(*alone), &b = reference_of(*more);
    EXPECT_EQ(a.program->memory_bytes(), b.program->memory_bytes());
    EXPECT_EQ(a.program->basis(), b.program->basis());
    EXPECT_EQ(some_patterns(a), some_patterns(b));
    EXPECT_EQ(more->lines.size(), 34u);
    EXPECT_TRUE(line_of(*more, "layer3").dropped);
    EXPECT_EQ(line_of(*more, "set3").note, "dropped: does not reach the output");
    EXPECT_FALSE(line_of(*more, "index").dropped);
}

TEST(Plan, GivesEachBlockTheCoarsestRate) {
    const auto plan = plan_of(tiles + R"(,
      {"name": "still", "probability_map": {"index": {"integer": 1}, "material": {"entries": [{"pattern": 5}, {"pattern": 6}]}}},
      {"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1}]}},
      {"name": "blink", "animation_map": {"sequence": "frames"}},
      {"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 2}},
      {"name": "twinkle", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}}},
      {"name": "a", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "still"}}},
      {"name": "b", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "blink"}}},
      {"name": "c", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "twinkle"}}},
      {"name": "all", "layers": {"textures": ["texture", "a", "b", "c"]}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    EXPECT_EQ(line_of(*plan, "set").rate, Rate::scene);
    EXPECT_EQ(line_of(*plan, "grid").rate, Rate::scene);
    EXPECT_EQ(line_of(*plan, "still").rate, Rate::scene);
    EXPECT_EQ(line_of(*plan, "still").note, "folded to 6");
    EXPECT_EQ(line_of(*plan, "blink").rate, Rate::step);
    EXPECT_EQ(line_of(*plan, "twinkle").rate, Rate::cell);
    EXPECT_EQ(line_of(*plan, "index").rate, Rate::cell);
    EXPECT_EQ(line_of(*plan, "index").note, "typed, 4096 types, draws 16");
    EXPECT_EQ(line_of(*plan, "phase").note, "independent, draws 2");  // What moves is drawn cell by cell
    EXPECT_EQ(line_of(*plan, "all").rate, Rate::texel);
    EXPECT_THAT(line_of(*plan, "grid").note, HasSubstr("4096 types"));
    ASSERT_EQ(plan->textures.size(), 5u);
    EXPECT_EQ(std::get<LayersPlan>(plan->textures.back().what).textures,
              (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST(Plan, WhatAConstantHidesIsDroppedAndCostsNoTypes) {
    const auto plan = plan_of(R"(
      {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
      {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
      {"name": "index", "virtual_indirection_map": {"grid": "grid", "count": 16}},
      {"name": "one", "probability_map": {"index": {"block": "index"}, "material": {"entries": [{"pattern": 3}, {"pattern": 3}]}}},
      {"name": "texture", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "one"}}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    EXPECT_EQ(line_of(*plan, "one").note, "folded to 3");
    EXPECT_TRUE(line_of(*plan, "index").dropped);
    const ReferencePlan& reference = reference_of(*plan);
    EXPECT_EQ(reference.grid.quadtree, nullptr);
    EXPECT_FALSE(reference.program->needs_types());
    EXPECT_EQ(reference.program->basis(), CellProgram::Basis::constant);
    EXPECT_EQ(reference.program->look_of_type(0).pattern, 3);
}

TEST(Plan, AMapOfOneValueIsAConstant) {
    const auto plan = plan_of(R"(
      {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
      {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
      {"name": "areas", "dithered_areas_map": {"areas": {"grid": "grid", "values": [4, 4, 4, 4], "width": 2, "cells": 16}}},
      {"name": "texture", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "areas"}}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    EXPECT_EQ(line_of(*plan, "areas").note, "folded to 4");
    EXPECT_EQ(reference_of(*plan).program->basis(), CellProgram::Basis::constant);
}

TEST(Plan, DrawsAreIndependentWhereLooksVaryAndEverywhereThatTheySpread) {
    // "index" is read by a texture that varies, so it is independent; so "turn", which a texture reads beside
    // it, is too
    const auto plan = plan_of(R"(
      {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
      {"name": "grid", "virtual_tile_map": {"cell_texels": 32}},
      {"name": "index", "virtual_indirection_map": {"grid": "grid", "count": 4}},
      {"name": "turn", "virtual_random_map": {"grid": "grid"}},
      {"name": "other", "virtual_indirection_map": {"grid": "grid", "count": 4}},
      {"name": "areas", "areas_map": {"grid": "grid", "values": [0, 1], "width": 2}},
      {"name": "material", "materials_map": {"material": {"block": "areas"}, "index": {"block": "index"},
          "materials": [{"entries": [{}]}, {"entries": [{"pattern": 1}, {"pattern": 2}]}]}},
      {"name": "move", "tile_transform": {"grid": "grid", "turn": {"block": "turn"}}},
      {"name": "still", "tile_transform": {"grid": "grid"}},
      {"name": "a", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "material"}, "transform": "still"}},
      {"name": "b", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "index"}, "transform": "move"}},
      {"name": "c", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "other"}, "transform": "still"}},
      {"name": "all", "layers": {"textures": ["a", "b", "c"]}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    EXPECT_EQ(line_of(*plan, "index").note, "independent, draws 4");
    EXPECT_THAT(line_of(*plan, "turn").note, HasSubstr("independent, draws 256"));
    EXPECT_EQ(line_of(*plan, "other").note, "typed, 4096 types, draws 4");
    const auto basis = [&](std::size_t i) {
        return std::get<ReferencePlan>(plan->textures[i].what).program->basis();
    };
    EXPECT_EQ(basis(0), CellProgram::Basis::varying);
    EXPECT_EQ(basis(1), CellProgram::Basis::stationary);
    EXPECT_EQ(basis(2), CellProgram::Basis::typed);
}

TEST(Plan, AnotherSeedDrawsOtherwiseAndAnotherBlockDoesNot) {
    const auto first = plan_of(tiles), again = plan_of(tiles), other = plan_of(tiles, R"("seed": "5")");
    const auto beside =
        plan_of(tiles + R"(, {"name": "more", "virtual_indirection_map": {"grid": "grid", "count": 16}},
        {"name": "second", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "more"}}},
        {"name": "both", "layers": {"textures": ["second", "texture"]}})");
    ASSERT_TRUE(first && again && other && beside);
    EXPECT_EQ(some_patterns(reference_of(*first)), some_patterns(reference_of(*again)));
    EXPECT_NE(some_patterns(reference_of(*first)), some_patterns(reference_of(*other)));
    for (const PlannedTexture& texture : beside->textures) {
        const auto* reference = std::get_if<ReferencePlan>(&texture.what);
        if (reference == nullptr) continue;
        EXPECT_EQ(some_patterns(*reference) == some_patterns(reference_of(*first)),
                  texture.name == "texture");
    }
}

TEST(Plan, TransformsKeepOnlyTheTurnsThatOccur) {
    const auto plan = plan_of(R"(
      {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
      {"name": "grid", "virtual_tile_map": {"cell_texels": 32}},
      {"name": "turn", "virtual_random_map": {"grid": "grid", "from": 0.25, "to": 0.5}},
      {"name": "scale", "virtual_random_map": {"grid": "grid", "from": 1, "to": 2}},
      {"name": "move", "tile_transform": {"grid": "grid", "turn": {"block": "turn"}, "scale": {"block": "scale"}, "scales": 3}},
      {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "transform": "move"}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    const ReferencePlan& reference = reference_of(*plan);
    ASSERT_EQ(reference.transform->turns.size(), 9u);
    EXPECT_EQ(reference.transform->turns.front(), 0.25);
    EXPECT_EQ(reference.transform->turns.back(), 0.5);
    EXPECT_EQ(reference.transform->scales, (std::vector<double>{1, 1.5, 2}));
    for (std::uint32_t type = 0; type < 4096; ++type) {
        const Look look = reference.program->look_of_type(static_cast<std::uint16_t>(type));
        ASSERT_LT(look.turn, 9);
        ASSERT_LT(look.scale, 3);
        ASSERT_EQ(look.x, 32768);
    }
}

}  // namespace
}  // namespace tessera
