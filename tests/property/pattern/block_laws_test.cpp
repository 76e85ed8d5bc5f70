// The same laws for cells as blocks draw them, by every generator.
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "server/pattern/cell_texture.h"
#include "tests/property/pattern/evaluated_page.h"
#include "tests/support/made_patterns.h"

namespace tessera {
namespace {

/// Random patterns; maps of random materials below 2.
class MadeFiles final : public BlockFiles {
  public:
    Result<PatternImages> read_patterns(const std::string&, const proto::PatternSet& set) override {
        return made_patterns(4, static_cast<std::int32_t>(set.count()));
    }
    Result<StoredMap> read_map(const std::string&, const std::string&) override {
        std::vector<std::int32_t> values;
        for (std::int64_t i = 0; i < 7 * 5; ++i)
            values.push_back(static_cast<std::int32_t>(hash(3, stream("map"), i, 0) % 2));
        return StoredMap{7, 5, values, StoredMap::Edge::wrap, 0, 0, 0};
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string&, const proto::Block&) override {
        return std::shared_ptr<const Texture>{};
    }
};

std::shared_ptr<const Texture> texture_of(const std::string& index, std::uint64_t seed) {
    const std::string json =
        R"({"seed": ")" + std::to_string(seed) +
        R"(", "blocks": [{"name": "set", "patternSet": {"image": "p.png", "sideTexels": 4, "count": 32}},
            {"name": "grid", "virtualTileMap": {"cellTexels": 4}},)" +
        index +
        R"(, {"name": "out", "referenceTexture": {"patterns": "set", "grid": "grid", "index": {"block": "index"}}}]})";
    proto::Pattern message;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, &message).ok()) << json;
    MadeFiles files;
    const auto plan = compile_plan(message, files);
    EXPECT_TRUE(plan) << (plan ? "" : plan.error().detail);
    return make_cell_texture(std::get<ReferencePlan>(plan->textures.back().what));
}

std::string indirection(const std::string& generator) {
    return R"({"name": "index", "virtualIndirectionMap": {"grid": "grid", "count": 32, "generator": ")" +
           generator + R"("}})";
}
std::string dithered(const std::string& generator, const std::string& axes) {
    return R"({"name": "index", "ditheredAreasMap": {"areas": {"grid": "grid", "image": "a", "cells": 32}, "axes": ")" +
           axes + R"(", "generator": ")" + generator + R"("}})";
}
std::string transitions(const std::string& material) {
    std::string combinations;
    for (int i = 0; i < 16; ++i)
        combinations += std::string(i == 0 ? "" : ", ") + R"({"corners": [)" + std::to_string(i & 1) + ", " +
                        std::to_string(i >> 1 & 1) + ", " + std::to_string(i >> 2 & 1) + ", " +
                        std::to_string(i >> 3) + R"(], "patterns": {"entries": [{"pattern": )" +
                        std::to_string(2 * i) + R"(}, {"pattern": )" + std::to_string(2 * i + 1) + "}]}}";
    return material +
           R"(, {"name": "choice", "virtualIndirectionMap": {"grid": "grid", "count": 2, "generator": "independent"}},
              {"name": "index", "transitionTiles": {"material": {"block": "material"}, "index": {"block": "choice"},
                  "families": 2, "combinations": [)" +
           combinations + "]}}";
}
std::string areas(const std::string& block) {
    return R"({"name": "material", ")" + block + R"(": {)" +
           (block == "ditheredAreasMap" ? R"("areas": {"grid": "grid", "image": "a", "cells": 16})"
                                        : R"("grid": "grid", "image": "a", "cells": 16)") +
           "}}";
}

const std::vector<std::pair<std::string, std::string>>& graphs() {
    static const std::vector<std::pair<std::string, std::string>> all{
        {"typed", indirection("typed")},
        {"independent", indirection("independent")},
        {"nested", indirection("nested")},
        {"sigma", indirection("sigma")},
        {"explicit",
         R"({"name": "index", "explicitIndirectionMap": {"grid": "grid", "image": "a", "x": "-3"}})"},
        {"dithered", dithered("independent", "both")},
        {"dithered along x", dithered("independent", "x_only")},
        {"nested dithered", dithered("nested", "both")},
        {"nested dithered along y", dithered("nested", "y_only")},
        {"transitions of areas", transitions(areas("areasMap"))},
        {"transitions of dithered areas", transitions(areas("ditheredAreasMap"))},
        {"transitions of drawn materials",
         transitions(R"({"name": "material", "virtualIndirectionMap": {"grid": "grid", "count": 2,
             "generator": "independent"}})")},
    };
    return all;
}

TEST(BlockLaws, APageIsTheReductionOfItsChildrenWithinTheStatedBounds) {
    for (const auto& [name, index] : graphs()) {
        const auto texture = texture_of(index, 1);
        for (const auto accuracy : {Accuracy::fast, Accuracy::high})
            for (std::uint8_t level = 1; level <= max_level; ++level) {
                const TexelRegion region{level, -9, std::int64_t{1} << (34 - level), 24, 16, 0};
                const EvaluatedPage page = page_of(*texture, region, accuracy);
                const EvaluatedPage below = page_of(*texture, children_of(region), accuracy);
                EXPECT_LE(difference_codes(page.texels, halved(below.texels)),
                          page.did.bound_codes + below.did.bound_codes)
                    << name << ", level " << int{level} << ", " << name_of(accuracy);
                if (name == "typed" || name == "explicit") {
                    EXPECT_LT(page.did.bound_codes, 0.02) << name << ", level " << int{level};
                }
            }
    }
}

/// Over many seeds: expectations against the cells that were drawn. None is outside, certain bounds never;
/// the others hold with 1 − 1e-9.
TEST(BlockLaws, NoTexelIsOutsideItsBoundOverManySeeds) {
    for (const auto& [name, index] : graphs()) {
        double largest = 0;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const auto texture = texture_of(index, seed);
            for (std::uint8_t level = 3; level <= 6; ++level) {  // texels of 2 to 16 cells a side
                const TexelRegion region{level, std::int64_t(seed) * 64 - 300, -8, 16, 16, 0};
                const EvaluatedPage drawn = page_of(*texture, region, Accuracy::exact);
                const EvaluatedPage expected = page_of(*texture, region, Accuracy::fast);
                const double difference = difference_codes(drawn.texels, expected.texels);
                ASSERT_LE(difference, expected.did.bound_codes + drawn.did.bound_codes)
                    << name << ", seed " << seed << ", level " << int{level};
                largest = std::max(largest, difference / expected.did.bound_codes);
            }
        }
        std::cout << name << ": at most " << largest << " of the bound\n";
    }
}

/// Nested draws: the certain bound falls like 4^-m.
TEST(BlockLaws, NestedDrawsHaveACertainBoundThatFallsFast) {
    const auto texture = texture_of(indirection("nested"), 1);
    double before = 1e9;
    for (std::uint8_t level = 6; level <= 11; ++level) {
        const EvaluatedPage page = page_of(*texture, {level, 0, 0, 4, 4, 0}, Accuracy::fast);
        EXPECT_EQ(page.did.confidence, 1);
        EXPECT_LT(page.did.bound_codes, before / 3.5) << int{level};
        before = page.did.bound_codes;
    }
}

}  // namespace
}  // namespace tessera
