#include "tests/property/stability/pattern_subjects.h"

#include <stdexcept>
#include <utility>

#include <google/protobuf/util/json_util.h>

#include "server/pattern/pattern_texture.h"
#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"
#include "shared/math/hash.h"
#include "tests/support/synthetic_asset.h"

namespace tessera::tests {
namespace {

/// Patterns, maps and a photograph that are nowhere but here. A set called "clear" has holes and a soft rim.
class MadeFiles final : public BlockFiles {
  public:
    explicit MadeFiles(int code) : code_{code} {}

    Result<PatternImages> read_patterns(const std::string&, const proto::PatternSet& set) override {
        const bool clear = set.image() == "clear";
        PatternImages images{static_cast<std::int32_t>(set.side_texels()),
                             static_cast<std::int32_t>(set.count()),
                             std::max(1, static_cast<std::int32_t>(set.slices())),
                             {}};
        for (std::int32_t image = 0; image < images.count * images.slices; ++image)
            for (std::int32_t y = 0; y < images.side; ++y)
                for (std::int32_t x = 0; x < images.side; ++x) {
                    const std::uint64_t bits =
                        hash(77, stream("made pattern", std::uint64_t(image)), x / 2, y / 2);
                    const std::int32_t u = 2 * x + 1 - images.side, v = 2 * y + 1 - images.side;
                    const bool inside = 10 * (u * u + v * v) < 9 * images.side * images.side;
                    for (int c = 0; c < 3; ++c)
                        images.codes.push_back(
                            code_ >= 0 ? static_cast<std::uint8_t>(code_)
                                       : static_cast<std::uint8_t>((bits >> (8 * c)) % 2 * 200 +
                                                                   std::uint64_t(image * 53 + c * 90) % 56));
                    images.codes.push_back(!clear   ? std::uint8_t{255}
                                           : inside ? static_cast<std::uint8_t>(100 + (bits >> 40) % 2 * 155)
                                                    : std::uint8_t{0});
                }
        return images;
    }
    Result<StoredMap> read_map(const std::string&, const std::string& image) override {
        const std::uint64_t states = image == "binary" ? 2 : 4;
        std::vector<std::int32_t> values;
        for (std::int64_t i = 0; i < 13 * 11; ++i)
            values.push_back(static_cast<std::int32_t>(hash(78, stream("made map"), i, 0) % states));
        return StoredMap{13, 11, values, StoredMap::Edge::wrap, 0, 0, 0};
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string&, const proto::Block&) override {
        return std::shared_ptr<const Texture>{
            make_exchange_texture(make_synthetic_asset({.constant_code = code_}), {.seed = 6, .types = 64})};
    }

  private:
    int code_;
};

/// Blocks that most scenes have: a grid of 8 texels, four patterns that fill its cells and four with holes.
const std::string common = R"(
    {"name": "cells", "virtual_tile_map": {"cell_texels": 8, "types": 256}},
    {"name": "set", "pattern_set": {"image": "opaque", "side_texels": 8, "count": 4}},
    {"name": "clear", "pattern_set": {"image": "clear", "side_texels": 8, "count": 4}},
    {"name": "many", "pattern_set": {"image": "opaque", "side_texels": 8, "count": 32}})";

std::string tiling(const std::string& blocks, const std::string& set = "set") {
    return blocks + R"(, {"name": "tiles", "reference_texture": {"patterns": ")" + set +
           R"(", "grid": "cells", "index": {"block": "which"}}})";
}
std::string drawn(const std::string& generator, int count = 4) {
    return R"({"name": "which", "virtual_indirection_map": {"grid": "cells", "count": )" +
           std::to_string(count) + R"(, "generator": ")" + generator + R"("}})";
}
std::string dithered(const std::string& generator, const std::string& axes) {
    return R"({"name": "which", "dithered_areas_map": {"areas": {"grid": "cells", "image": "map", "cells": 8}, "axes": ")" +
           axes + R"(", "generator": ")" + generator + R"("}})";
}
std::string areas(const std::string& name, const std::string& more) {
    return R"({"name": ")" + name + R"(", "areas_map": {"grid": "cells", "image": "binary", "cells": 8)" +
           more + "}}";
}
/// Tiles for all sixteen corners of two families; `family` for the bordered kind.
std::string transitions(const std::string& family = "") {
    std::string combinations;
    for (int i = 0; i < 16; ++i)
        combinations += std::string(i == 0 ? "" : ", ") + R"({"corners": [)" + std::to_string(i & 1) + ", " +
                        std::to_string(i >> 1 & 1) + ", " + std::to_string(i >> 2 & 1) + ", " +
                        std::to_string(i >> 3) + R"(], "patterns": {"entries": [{"pattern": )" +
                        std::to_string(2 * i) + R"(}, {"pattern": )" + std::to_string(2 * i + 1) + "}]}}";
    return R"({"name": "choice", "virtual_indirection_map": {"grid": "cells", "count": 2, "generator": "independent"}},
              {"name": "which", "transition_tiles": {"material": {"block": "material"}, "index": {"block": "choice"},
                  "families": 2, )" +
           family + R"("combinations": [)" + combinations + "]}}";
}
std::string instances(const std::string& overflow, const std::string& generator) {
    std::string blocks;
    for (const char* number : {R"(x", "virtual_random_map": {)", R"(y", "virtual_random_map": {)",
                               R"(turn", "virtual_random_map": {"levels": 8, "to": 0.875, )",
                               R"(scale", "virtual_random_map": {"from": 0.4, "to": 0.7, "levels": 4, )"})
        blocks += std::string{R"({"name": ")"} + number + R"("grid": "cells", "generator": ")" + generator +
                  R"("}}, )";
    return blocks + drawn(generator) + R"(,
        {"name": "place", "tile_transform": {"grid": "cells", "x": {"block": "x"}, "y": {"block": "y"},
            "turn": {"block": "turn"}, "scale": {"block": "scale"}, "turns": 8, "scales": 2, "overflow": )" +
           overflow + R"(}},
        {"name": "things", "reference_texture": {"patterns": "clear", "grid": "cells", "index": {"block": "which"},
            "transform": "place"}})";
}

struct Made {
    std::string name;
    std::string blocks;
    std::int32_t side = 24;
    bool see_through = false;  ///< Lies on a ground where all is of one colour.
    bool has_slices = false;
    bool composites = false;
};

std::vector<Made> made() {
    const std::string layered = R"(
        {"name": "fine", "virtual_tile_map": {"cell_texels": 4, "types": 256}},
        {"name": "small", "pattern_set": {"image": "clear", "side_texels": 4, "count": 4}},
        {"name": "dots-which", "virtual_indirection_map": {"grid": "fine", "count": 4}},
        {"name": "dots", "reference_texture": {"patterns": "small", "grid": "fine", "index": {"block": "dots-which"}}}, )";
    return {
        {"typed", tiling(drawn("typed"))},
        {"independent", tiling(drawn("independent"))},
        {"nested", tiling(drawn("nested"))},
        {"sigma", tiling(drawn("sigma"))},
        {"many_independent", tiling(drawn("independent", 32), "many")},
        {"explicit",
         tiling(
             R"({"name": "which", "explicit_indirection_map": {"grid": "cells", "image": "map", "x": "-3"}})")},
        {"explicit_blank_outside",
         tiling(
             R"({"name": "which", "explicit_indirection_map": {"grid": "cells", "values": [0, 1, 2, 3, -1, 2], "width": 3, "cells": 4, "edge": "blank"}})"),
         24, true},
        {"explicit_clamped",
         tiling(
             R"({"name": "which", "explicit_indirection_map": {"grid": "cells", "image": "map", "cells": 16, "edge": "clamp", "x": "-32"}})")},
        {"probability", tiling(R"({"name": "draw", "virtual_indirection_map": {"grid": "cells", "count": 8}},
             {"name": "which", "probability_map": {"index": {"block": "draw"}, "material": {"entries": [{"pattern": 1, "weight": 5}, {"pattern": 2}, {"pattern": -1, "weight": 2}]}}})"),
         24, true},
        {"materials", tiling(areas("area", "") + R"(,
             {"name": "draw", "virtual_indirection_map": {"grid": "cells", "count": 4, "generator": "independent"}},
             {"name": "which", "materials_map": {"material": {"block": "area"}, "index": {"block": "draw"}, "materials": [
               {"entries": [{"pattern": 0}, {"pattern": 1}]}, {"entries": [{"pattern": 2, "weight": 3}, {"pattern": 3}]}]}})")},
        {"dithered", tiling(dithered("independent", "both"))},
        {"dithered_along_x", tiling(dithered("independent", "x_only"))},
        {"dithered_along_y_nested", tiling(dithered("nested", "y_only"))},
        {"dithered_nested", tiling(dithered("nested", "both"))},
        {"transitions_of_areas", tiling(areas("material", "") + ", " + transitions(), "many")},
        {"transitions_of_dithered_areas",
         tiling(
             R"({"name": "material", "dithered_areas_map": {"areas": {"grid": "cells", "image": "binary", "cells": 16}}}, )" +
                 transitions(),
             "many")},
        {"transitions_of_draws",
         tiling(
             R"({"name": "material", "virtual_indirection_map": {"grid": "cells", "count": 2, "generator": "independent"}}, )" +
                 transitions(),
             "many")},
        {"transitions_bordered",
         tiling(areas("material", R"(, "edge": "clamp")") + ", " + transitions(R"("family": 1, )"), "many")},
        {"animation",
         tiling(
             R"({"name": "film", "animation_sequence": {"frames": [{"pattern": 0, "steps": 2}, {"pattern": 1}, {"pattern": 3}]}},
             {"name": "phase", "virtual_indirection_map": {"grid": "cells", "count": 16}},
             {"name": "which", "animation_map": {"sequence": "film", "phase": {"block": "phase"}, "rest": {"integer": 3}}})")},
        {"instances", instances("false", "typed"), 24, true, false, true},
        {"instances_independent", instances("false", "independent"), 12, true, false, true},
        {"overflow", instances("true", "typed"), 16, true, false, true},
        {"overflow_independent", instances("true", "independent"), 8, true, false, true},
        {"slices",
         R"({"name": "deep", "virtual_tile_map": {"cell_texels": 8, "cell_slices": 4, "types": 128}},
             {"name": "volume", "pattern_set": {"image": "opaque", "side_texels": 8, "count": 3, "slices": 4}},
             {"name": "which", "virtual_indirection_map": {"grid": "deep", "count": 3}},
             {"name": "tiles", "reference_texture": {"patterns": "volume", "grid": "deep", "index": {"block": "which"}}})",
         24, false, true},
        {"layers_of_one_grid",
         drawn("typed") +
             R"(, {"name": "tiles", "reference_texture": {"patterns": "set", "grid": "cells", "index": {"block": "which"}}},
             {"name": "over-which", "virtual_indirection_map": {"grid": "cells", "count": 4}},
             {"name": "over", "reference_texture": {"patterns": "clear", "grid": "cells", "index": {"block": "over-which"}}},
             {"name": "layers", "layers": {"textures": ["tiles", "over"]}})",
         16},
        {"layers_of_two_grids",
         layered + tiling(drawn("typed")) +
             R"(, {"name": "layers", "layers": {"textures": ["tiles", "dots"]}})",
         8, false, false, true},
        {"layers_over_photograph",
         R"({"name": "ground", "content_exchange": {"asset": "made"}}, )" + instances("true", "typed") +
             R"(, {"name": "layers", "layers": {"textures": ["ground", "things"]}})",
         6, false, false, true},
        {"pixel_map",
         tiling(drawn("typed")) + ", " + layered +
             R"({"name": "ground", "content_exchange": {"asset": "made"}},
             {"name": "mask", "pixel_map": {"image": "map", "textures": ["tiles", "ground", "ground", "tiles"], "texels": 4}})",
         6, false, false, true},
    };
}

std::shared_ptr<const Texture> texture_of(const std::string& name, const std::string& blocks, int code) {
    proto::Pattern message;
    const std::string json = R"({"seed": "11", "blocks": [)" + common + ", " + blocks + "]}";
    const auto status = google::protobuf::util::JsonStringToMessage(json, &message);
    if (!status.ok()) throw std::logic_error{name + ": " + status.ToString() + json};
    MadeFiles files{code};
    const auto plan = compile_plan(message, files);
    if (!plan) throw std::logic_error{name + ": " + plan.error().detail};
    return make_pattern_texture(*plan);
}

}  // namespace

std::vector<Subject> pattern_subjects(int code) {
    std::vector<Subject> all;
    for (const Made& one : made()) {
        std::string blocks = one.blocks;
        if (code >= 0 && one.see_through) {
            const std::string top = blocks.find("\"things\"") != std::string::npos ? "things" : "tiles";
            const std::string value = std::to_string(code);
            blocks += R"(, {"name": "under", "constant": {"red": )" + value + R"(, "green": )" + value +
                      R"(, "blue": )" + value +
                      R"(}}, {"name": "on-ground", "layers": {"textures": ["under", ")" + top + R"("]}})";
        }
        all.push_back({"pattern_" + one.name, texture_of(one.name, blocks, code), one.side, one.has_slices,
                       one.composites});
    }
    return all;
}

}  // namespace tessera::tests
