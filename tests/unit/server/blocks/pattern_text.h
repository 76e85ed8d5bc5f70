#pragma once

#include <map>
#include <string>

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "server/blocks/plan.h"

namespace tessera {

/// Files of a test: pattern sets of any size asked for, and maps by name.
class TestFiles final : public BlockFiles {
  public:
    std::map<std::string, StoredMap> maps;
    int reads = 0;

    Result<PatternImages> read_patterns(const std::string&, const proto::PatternSet& set) override {
        ++reads;
        PatternImages images;
        images.side = static_cast<std::int32_t>(set.side_texels() == 0 ? 1 : set.side_texels());
        images.count = static_cast<std::int32_t>(set.count() == 0 ? 16 : set.count());
        images.slices = static_cast<std::int32_t>(set.slices() == 0 ? 1 : set.slices());
        const auto texels =
            static_cast<std::size_t>(images.side * images.side * images.count * images.slices);
        images.codes.assign(texels * 4, 255);
        return images;
    }
    Result<StoredMap> read_map(const std::string& field, const std::string& image) override {
        ++reads;
        const auto found = maps.find(image);
        if (found == maps.end())
            return Error{ErrorCode::invalid_input, field + ": no file \"" + image + "\""};
        return found->second;
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string&, const proto::Block&) override {
        ++reads;
        return std::shared_ptr<const Texture>{};
    }
};

/// A pattern from the lines of its "blocks" list.
inline proto::Pattern pattern_of(const std::string& blocks, const std::string& more = "") {
    proto::Pattern pattern;
    const std::string json = "{\"blocks\": [" + blocks + "]" + (more.empty() ? "" : ", " + more) + "}";
    const auto status = google::protobuf::util::JsonStringToMessage(json, &pattern);
    EXPECT_TRUE(status.ok()) << status.ToString() << "\n" << json;
    return pattern;
}

inline Result<Plan> plan_of(const std::string& blocks, const std::string& more = "") {
    TestFiles files;
    return compile_plan(pattern_of(blocks, more), files);
}

/// The program of the last reference texture.
inline const ReferencePlan& reference_of(const Plan& plan) {
    const ReferencePlan* last = nullptr;
    for (const PlannedTexture& texture : plan.textures)
        if (const auto* reference = std::get_if<ReferencePlan>(&texture.what)) last = reference;
    EXPECT_NE(last, nullptr);
    return *last;
}

/// The combinations of two families at four corners; bit k of a combination is corner k.
template <class PatternOf>
std::string sixteen_combinations(const PatternOf& pattern_of_combination) {
    std::string all;
    for (int i = 0; i < 16; ++i)
        all += std::string{i == 0 ? "" : ","} + R"({"corners": [)" + std::to_string(i & 1) + "," +
               std::to_string(i >> 1 & 1) + "," + std::to_string(i >> 2 & 1) + "," +
               std::to_string(i >> 3 & 1) + R"(], "patterns": {"entries": [{"pattern": )" +
               std::to_string(pattern_of_combination(i)) + "}]}}";
    return all;
}

}  // namespace tessera
