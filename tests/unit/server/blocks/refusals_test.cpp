// Bad scene files: each fault is refused, and told with its field and what would be right.
#include <limits>

#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string set = R"({"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},)";
const std::string grid = R"({"name": "grid", "virtual_tile_map": {"cell_texels": 8}},)";
const std::string index = R"({"name": "index", "virtual_indirection_map": {"grid": "grid", "count": 16}},)";
const std::string texture =
    R"({"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "index"}}})";

/// "accepted", or the message. Where a fault is refused, it is refused in blocks that do not reach the
/// output, too, in the same words.
std::string refusal(const proto::Pattern& pattern) {
    TestFiles files;
    const auto plan = compile_plan(pattern, files);
    if (plan) return "accepted";
    EXPECT_EQ(plan.error().code, ErrorCode::invalid_input);
    if (pattern.blocks_size() == 0 || !pattern.output().empty()) return plan.error().detail;
    proto::Pattern unreached = pattern;
    proto::Block& plain = *unreached.add_blocks();
    plain.set_name("plain");
    plain.mutable_constant();
    const auto dropped = compile_plan(unreached, files);
    if (pattern.blocks_size() < 4096) {
        EXPECT_EQ(dropped ? "accepted" : dropped.error().detail, plan.error().detail);
    }
    return plan.error().detail;
}

std::string refusal(const std::string& blocks, const std::string& more = "") {
    return refusal(pattern_of(blocks, more));
}

/// The fault of one block "x", in a pattern that shows it as "index".
std::string refusal_of(const std::string& block) {
    return refusal(set + grid + block + R"(, {"name": "t", "reference_texture":
        {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})");
}

std::string of_map(const std::string& fields) {
    return refusal_of(R"({"name": "x", "areas_map": {"grid": "grid", )" + fields + "}}");
}

TEST(Refusals, NameBlocksThatAreMissingOrNamedTwice) {
    EXPECT_THAT(refusal(""), StartsWith("pattern.blocks: is empty"));
    EXPECT_EQ(refusal(set + grid + texture),
              "pattern.blocks[2] \"t\".index: names \"index\", which is no block of this pattern; it needs "
              "an integer");
    EXPECT_EQ(refusal(set + grid + index + index + texture),
              "pattern.blocks[3] \"index\".name: is also the name of pattern.blocks[2]; names are unique");
    EXPECT_THAT(refusal(R"({"name": "a b"})"),
                StartsWith("pattern.blocks[0].name: is \"a b\"; a name has 1 to 64"));
    EXPECT_THAT(refusal(R"({"name": "a"})"), StartsWith("pattern.blocks[0] \"a\": holds no block"));
    EXPECT_THAT(refusal(set + grid + index + texture, R"("output": "u")"),
                StartsWith("pattern.output: names \"u\", which is no block"));
    EXPECT_THAT(refusal(set + grid + index + texture, R"("output": "grid")"),
                StartsWith("pattern.output: is \"grid\", a virtual_tile_map"));
}

TEST(Refusals, NameWhatABlockGivesAndWhatIsNeeded) {
    EXPECT_EQ(
        refusal(set + grid + R"({"name": "t", "reference_texture": {"patterns": "grid", "grid": "grid"}})"),
        "pattern.blocks[2] \"t\".patterns: names \"grid\", a virtual_tile_map, which gives a grid; it needs "
        "a "
        "pattern set");
    EXPECT_EQ(refusal(set + grid + R"({"name": "t", "reference_texture": {"patterns": "set"}})"),
              "pattern.blocks[2] \"t\".grid: is missing; the name of a block that gives a grid");
    EXPECT_THAT(refusal(set + grid + R"({"name": "t", "reference_texture": {"patterns": "set", "grid": "grid",
                                         "index": {"number": 0.5}}})"),
                StartsWith("pattern.blocks[2] \"t\".index: is the number 0.5; an integer is needed"));
}

TEST(Refusals, ShowTheWayRoundACycle) {
    const std::string round =
        R"({"name": "a", "probability_map": {"index": {"block": "b"}, "material": {"entries": [{}]}}},
                                 {"name": "b", "probability_map": {"index": {"block": "c"}, "material": {"entries": [{}]}}},
                                 {"name": "c", "probability_map": {"index": {"block": "a"}, "material": {"entries": [{}]}}},)";
    EXPECT_THAT(refusal(round + set + grid + index + texture), HasSubstr("cycle, a -> b -> c -> a;"));
    EXPECT_THAT(refusal(R"({"name": "a", "layers": {"textures": ["a"]}})"),
                StartsWith("pattern.blocks[0] \"a\".textures[0]: closes a cycle, a -> a;"));
}

TEST(Refusals, TenThousandBlocksAreTooManyAndALongChainIsNot) {
    proto::Pattern pattern = pattern_of(set + grid + R"({"name": "c0", "virtual_indirection_map":
                                                         {"grid": "grid", "count": 2}})");
    const auto chain = [&](int count) {
        for (int i = 1; i <= count; ++i) {
            proto::Block& block = *pattern.add_blocks();
            block.set_name("c" + std::to_string(i));
            block.mutable_probability_map()->mutable_index()->set_block("c" + std::to_string(i - 1));
            auto& entries = *block.mutable_probability_map()->mutable_material();
            entries.add_entries()->set_pattern(1);
            entries.add_entries()->set_pattern(0);
        }
        proto::ReferenceTexture& shown = *pattern.add_blocks()->mutable_reference_texture();
        pattern.mutable_blocks(pattern.blocks_size() - 1)->set_name("t");
        shown.set_patterns("set");
        shown.set_grid("grid");
        shown.mutable_index()->set_block("c" + std::to_string(count));
    };
    const proto::Pattern start = pattern;
    chain(9996);
    EXPECT_EQ(refusal(pattern), "pattern.blocks: holds 10000 blocks; at most 4096");
    pattern = start;
    chain(4092);
    TestFiles files;
    const auto plan = compile_plan(pattern, files);
    ASSERT_TRUE(plan) << plan.error().detail;
    // 4092 swaps of 0 and 1 change nothing; all are one table
    const CellProgram& program = *reference_of(*plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::typed);

    // The same, round and round
    pattern.mutable_blocks(3)->mutable_probability_map()->mutable_index()->set_block("c4092");
    EXPECT_THAT(refusal(pattern), AllOf(HasSubstr("closes a cycle, "), HasSubstr(" more … ")));
}

TEST(Refusals, TexturesThatShowOneAnotherThroughExponentiallyManyWays) {
    for (const std::string kind : {"layers", "pixel_map"}) {
        std::string blocks = R"({"name": "t0", "constant": {"red": 9}})";
        for (int i = 1; i <= 40; ++i) {
            const std::string below = "\"t" + std::to_string(i - 1) + "\"";
            blocks += R"(, {"name": "t)" + std::to_string(i) + R"(", ")" + kind + R"(": {"textures": [)" +
                      below + ", " + below + "]" + (kind == "pixel_map" ? R"(, "image": "map.png")" : "") +
                      "}}";
        }
        TestFiles files;
        files.maps["map.png"] = StoredMap{.width = 1, .height = 1, .values = {0}};
        const auto plan = compile_plan(pattern_of(blocks), files);
        ASSERT_FALSE(plan);
        EXPECT_THAT(plan.error().detail,
                    AllOf(HasSubstr("\"t10\".textures: show 2047 textures"), HasSubstr("at most 1024")))
            << kind;
    }
}

TEST(Refusals, InputsOnOtherGrids) {
    const std::string other = R"({"name": "other", "virtual_tile_map": {"cell_texels": 16}},
        {"name": "areas", "areas_map": {"grid": "other", "values": [0, 1], "width": 2}},)";
    EXPECT_THAT(
        refusal(
            set + grid + index + other +
            R"({"name": "m", "materials_map": {"material": {"block": "areas"}, "index": {"block": "index"},
                            "materials": [{"entries": [{}]}, {"entries": [{"pattern": 1}]}]}},
                           {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "m"}}})"),
        StartsWith("pattern.blocks[5] \"m\": its inputs live on different grids, \"other\" and \"grid\""));
    EXPECT_THAT(
        refusal(
            set + grid + other +
            R"({"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "areas"}}})"),
        StartsWith("pattern.blocks[4] \"t\".index: lives on the grid \"other\", the texture on \"grid\""));
}

TEST(Refusals, GridsAndPatternSetsOutOfRange) {
    const std::string shown = R"({"name": "t", "reference_texture": {"patterns": "set", "grid": "grid"}})";
    for (const char* fields : {R"("cell_texels": 0)", R"("cell_texels": 24)", R"("cell_texels": 8192)"})
        EXPECT_THAT(refusal(set + R"({"name": "grid", "virtual_tile_map": {)" + fields + "}}," + shown),
                    HasSubstr("a power of two from 1 to 4096"));
    for (const char* types : {"32", "100", "32768"})
        EXPECT_EQ(refusal(set + R"({"name": "grid", "virtual_tile_map": {"cell_texels": 8, "types": )" +
                          types + "}}," + shown),
                  std::string{"pattern.blocks[1] \"grid\".types: is "} + types +
                      "; a power of two from 64 to 16384");
    EXPECT_THAT(refusal(R"({"name": "set", "pattern_set": {}},)" + grid + shown),
                StartsWith("pattern.blocks[0] \"set\".pattern_set: has neither image nor files"));
    EXPECT_THAT(
        refusal(R"({"name": "set", "pattern_set": {"image": "a.png", "side_texels": 12}},)" + grid + shown),
        StartsWith("pattern.blocks[0] \"set\".pattern_set.side_texels: is 12; a power of two"));
    EXPECT_THAT(
        refusal(R"({"name": "set", "pattern_set": {"image": "a.png", "side_texels": 16}},)" + grid + shown),
        StartsWith("pattern.blocks[2] \"t\".patterns: names patterns of 16 texels, and the cells of \"grid\" "
                   "have 8; make them the same"));
}

TEST(Refusals, MapsOfWrongSizeAndPlace) {
    EXPECT_EQ(of_map(R"("values": [1, 2, 3], "width": 2)"),
              "pattern.blocks[2] \"x\".values: has 3 entries, no whole rows of width 2; add or remove some");
    EXPECT_THAT(of_map(R"("values": [1, 2])"), StartsWith("pattern.blocks[2] \"x\".width: is 0;"));
    EXPECT_THAT(of_map(R"("width": 2)"), HasSubstr("has neither image nor values"));
    EXPECT_THAT(of_map(R"("values": [1], "image": "a.png", "width": 1)"),
                HasSubstr("has both image and values"));
    EXPECT_EQ(of_map(R"("values": [1], "width": 1, "cells": 3)"),
              "pattern.blocks[2] \"x\".cells: is 3; a power of two from 1 to 65536");
    EXPECT_EQ(of_map(R"("values": [1], "width": 1, "cells": 4, "x": "6")"),
              "pattern.blocks[2] \"x\".x: is 6; a multiple of cells, 4");
    EXPECT_THAT(of_map(R"("values": [1], "width": 1, "y": "1099511627776")"),
                HasSubstr("less than 2^40 cells"));
    EXPECT_EQ(of_map(R"("values": [1, -2], "width": 2)"),
              "pattern.blocks[2] \"x\".values[1]: is -2; from 0 on, or -1 for blank");
    EXPECT_THAT(of_map(R"("image": "none.png")"), HasSubstr("pattern.blocks[2] \"x\".image: no file"));
    TestFiles files;
    files.maps["empty.png"] = {};
    const auto plan =
        compile_plan(pattern_of(set + grid +
                                R"({"name": "x", "areas_map": {"grid": "grid", "image": "empty.png"}},
        {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})"),
                     files);
    ASSERT_FALSE(plan);
    EXPECT_THAT(plan.error().detail, StartsWith("pattern.blocks[2] \"x\".image: is a map of 0 × 0 entries"));
}

TEST(Refusals, IndicesThatCanReachOutsideTheSet) {
    EXPECT_EQ(of_map(R"("values": [1, 16], "width": 2)"),
              "pattern.blocks[3] \"t\".index: can be from 1 to 16, but \"set\" holds patterns 0 to 15; add "
              "patterns, or "
              "choose among these");
    EXPECT_EQ(of_map(R"("values": [1, -1], "width": 2)"), "accepted") << "−1 is blank";
    EXPECT_THAT(
        refusal_of(R"({"name": "x", "probability_map": {"material": {"entries": [{"pattern": 99}]}}})"),
        HasSubstr("\"t\".index: is 99, but"));
    EXPECT_THAT(
        refusal_of(R"({"name": "x", "probability_map": {"material": {"entries": [{"pattern": -2}]}}})"),
        HasSubstr(".material.entries[0].pattern: is -2;"));
    EXPECT_THAT(refusal(set + grid + R"({"name": "t", "reference_texture": {"patterns": "set", "grid": "grid",
                                         "index": {"integer": -2}}})"),
                HasSubstr(".index: is -2; an integer from -1"));
}

TEST(Refusals, ProbabilitiesOfZeroEverywhere) {
    EXPECT_EQ(refusal_of(R"({"name": "x", "probability_map": {"material":
                             {"entries": [{"pattern": 1, "weight": 0}, {"pattern": 2, "weight": 0}]}}})"),
              "pattern.blocks[2] \"x\".material: has the weight 0 everywhere; give one entry a weight");
    EXPECT_THAT(refusal_of(R"({"name": "x", "probability_map": {}})"),
                HasSubstr("\"x\".material: lists no entry"));
    EXPECT_THAT(refusal_of(R"({"name": "x", "probability_map": {"material":
                               {"entries": [{"weight": 65000}, {"weight": 600}]}}})"),
                HasSubstr(".material.entries[1].weight: brings the sum of weights to 65600; at most 65536"));
}

TEST(Refusals, MaterialsThatAreBlankOrMissing) {
    const auto materials = [](const std::string& areas) {
        return refusal_of(R"({"name": "areas", "areas_map": {"grid": "grid", )" + areas + R"(}},
          {"name": "x", "materials_map": {"material": {"block": "areas"},
             "materials": [{"entries": [{}]}, {"entries": [{"pattern": 1}]}]}})");
    };
    EXPECT_EQ(materials(R"("values": [0, 1], "width": 2)"), "accepted");
    EXPECT_EQ(materials(R"("values": [0, 2], "width": 2)"),
              "pattern.blocks[3] \"x\".material: can be from 0 to 2; materials are from 0 to 1");
    EXPECT_THAT(materials(R"("values": [0, 1], "width": 2, "edge": "blank")"),
                HasSubstr("can be from -1 to 1;"));
}

std::string transitions(int count, const std::string& more = "") {
    std::string text = R"({"name": "areas", "areas_map": {"grid": "grid", "values": [0, 1], "width": 2}},
        {"name": "x", "transition_tiles": {"material": {"block": "areas"}, "families": 2, "combinations": [)";
    for (int i = 0; i < count; ++i)
        text += std::string{i == 0 ? "" : ","} + R"({"corners": [)" + std::to_string(i & 1) + "," +
                std::to_string(i >> 1 & 1) + "," + std::to_string(i >> 2 & 1) + "," +
                std::to_string(i >> 3 & 1) +
                R"(], "patterns": {"entries": [{"pattern": 1}, {"pattern": 2}]}})";
    return text + more + "]}}";
}

TEST(Refusals, TransitionTilesThatAreMissingOrListedTwice) {
    EXPECT_EQ(refusal_of(transitions(16)), "accepted");
    EXPECT_EQ(refusal_of(transitions(15)),
              "pattern.blocks[3] \"x\".combinations: lacks the corners 1, 1, 1, 1; list all 16 combinations");
    EXPECT_THAT(refusal_of(transitions(10)), HasSubstr("lacks the corners 0, 1, 0, 1 and 5 more;"));
    EXPECT_THAT(
        refusal_of(transitions(16, R"(, {"corners": [1,0,1,0], "patterns": {"entries": [{}]}})")),
        HasSubstr(".combinations[16].corners: repeats 1, 0, 1, 0 of combinations[5]; list each once"));
    EXPECT_THAT(refusal_of(transitions(16, R"(, {"corners": [1,0,2,0], "patterns": {"entries": [{}]}})")),
                HasSubstr(".combinations[16].corners[2]: is 2; below 2"));
    EXPECT_THAT(refusal_of(transitions(16, R"(, {"corners": [1,0,2]})")), HasSubstr("lists 3 corners; four"));
}

TEST(Refusals, TransformsWithoutScaleOrRoom) {
    const auto transform = [](const proto::Value& scale, const std::string& more = "") {
        proto::Pattern pattern =
            pattern_of(set + R"({"name": "grid", "virtual_tile_map": {"cell_texels": 16}},
            {"name": "move", "tile_transform": {"grid": "grid")" +
                       more + R"(}},
            {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "transform": "move"}})");
        *pattern.mutable_blocks(2)->mutable_tile_transform()->mutable_scale() = scale;
        return refusal(pattern);
    };
    proto::Value scale;
    scale.set_number(1.5);
    EXPECT_EQ(transform(scale), "accepted");
    for (const double bad : {0.0, -1.0, 5.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
        scale.set_number(bad);
        EXPECT_THAT(transform(scale), AllOf(StartsWith("pattern.blocks[2] \"move\".scale: is "),
                                            HasSubstr("; a number from 0.015625 to 4")));
    }
    scale.set_number(3);
    EXPECT_THAT(transform(scale),
                AllOf(StartsWith("pattern.blocks[3] \"t\".transform: scales patterns of 8 texels by "
                                 "up to 3;"),
                      HasSubstr("The largest scale that fits is 2")));
    scale.set_number(1.5);
    EXPECT_THAT(transform(scale, R"(, "turn": {"number": 0.125})"),
                HasSubstr("The largest scale that fits is 1.4"));
    EXPECT_THAT(transform(scale, R"(, "turns": 300)"), HasSubstr(".turns: is 300; from 1 to 256"));
}

TEST(Refusals, GeneratorsThatCannotKeepTheirWord) {
    EXPECT_EQ(refusal_of(R"({"name": "x", "dithered_areas_map": {"generator": "typed", "areas":
                  {"grid": "grid", "values": [0, 1], "width": 2, "cells": 8}}})"),
              "pattern.blocks[2] \"x\".generator: is typed; independent or nested: what a dithered map draws "
              "varies over the plane");
    EXPECT_THAT(
        refusal_of(R"({"name": "areas", "areas_map": {"grid": "grid", "values": [0, 1], "width": 2}},
                  {"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 2, "generator": "typed"}},
                  {"name": "x", "materials_map": {"material": {"block": "areas"}, "index": {"block": "draw"},
                     "materials": [{"entries": [{}]}, {"entries": [{"pattern": 1}]}]}})"),
        AllOf(StartsWith("pattern.blocks[3] \"draw\".generator: is typed, but the looks of \"t\" vary"),
              HasSubstr("\"areas\"")));
    EXPECT_THAT(
        refusal_of(
            R"({"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 2, "generator": "nested"}},
                  {"name": "x", "transition_tiles": {"families": 2, "material": {"block": "draw"}, "combinations": [)" +
            transitions(16).substr(transitions(16).find("combinations\": [") + 16)),
        HasSubstr("\"draw\".generator: is nested, whose neighbours avoid each other"));
}

TEST(Refusals, NumbersThatAreNone) {
    proto::Pattern pattern =
        pattern_of(set + grid + index + R"({"name": "r", "virtual_random_map": {"grid": "grid"}},
        {"name": "move", "tile_transform": {"grid": "grid", "x": {"block": "r"}}},
        {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "transform": "move"}})");
    EXPECT_EQ(refusal(pattern), "accepted");
    pattern.mutable_blocks(3)->mutable_virtual_random_map()->set_to(std::numeric_limits<double>::quiet_NaN());
    EXPECT_THAT(refusal(pattern),
                StartsWith("pattern.blocks[3] \"r\".to: is nan; a number from -32767 to 32767"));
    pattern.mutable_blocks(3)->mutable_virtual_random_map()->set_to(2);
    EXPECT_THAT(refusal(pattern),
                StartsWith("pattern.blocks[4] \"move\".x: can be from 0 to 2; a number from 0 to 1"));
    pattern.mutable_blocks(3)->mutable_virtual_random_map()->set_levels(1);
    EXPECT_THAT(refusal(pattern), HasSubstr(".levels: is 1; from 2 to 65536"));
}

TEST(Refusals, PixelMapsWithCodesThatNoTextureHas) {
    TestFiles files;
    files.maps["mask.png"] = {.width = 2, .height = 2, .values = {0, 1, 0, 2}};
    const auto compile = [&](const std::string& fields) {
        const auto plan =
            compile_plan(pattern_of(R"({"name": "a", "constant": {"red": 1}}, {"name": "b", "constant": {}},
            {"name": "mask", "pixel_map": {"image": "mask.png", )" +
                                    fields + "}}"),
                         files);
        return plan ? std::string{"accepted"} : plan.error().detail;
    };
    EXPECT_EQ(compile(R"("textures": ["a", "b", "a"])"), "accepted");
    EXPECT_THAT(compile(R"("textures": ["a", "b"])"),
                HasSubstr("holds the code 2 at (1, 1), but textures has 2"));
    EXPECT_THAT(refusal(R"({"name": "a", "constant": {}},
                           {"name": "mask", "pixel_map": {"values": [0, 1], "width": 2, "textures": ["a"]}})"),
                HasSubstr("\"mask\".values: holds the code 1 at (1, 0)"));
    EXPECT_THAT(compile(R"("textures": ["a", "b", "a"], "texels": 3)"),
                HasSubstr(".texels: is 3; a power of two"));
    EXPECT_THAT(compile(R"("textures": ["a", "b", "a"], "edge": "blank")"), HasSubstr(".edge: is neither"));
}

}  // namespace
}  // namespace tessera
