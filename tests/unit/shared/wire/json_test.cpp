#include "shared/wire/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/scene.pb.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Json, AnUnknownFieldIsAnErrorThatNamesItAndTheFile) {
    proto::Scene scene;
    const auto read = read_json(R"({"checker": {"cell_texel": 3}})", "board/scene.json", scene);
    ASSERT_FALSE(read.has_value());
    EXPECT_EQ(read.error().code, ErrorCode::invalid_input);
    EXPECT_THAT(read.error().detail, HasSubstr("board/scene.json"));
    EXPECT_THAT(read.error().detail, HasSubstr("cell_texel"));
    EXPECT_TRUE(read_json_leniently(R"({"checker": {"cell_texel": 3}})", "x", scene).has_value());
}

TEST(Json, AWrongTypeIsAnErrorThatNamesTheField) {
    proto::Scene scene;
    const auto read = read_json(R"({"extent_log2_pages": "many"})", "scene.json", scene);
    ASSERT_FALSE(read.has_value());
    EXPECT_THAT(read.error().detail, HasSubstr("extent_log2_pages"));
}

TEST(Json, SaysWhatIsWrongInWordsAndWhichFieldWasMeant) {
    const auto told = [](const char* text) {
        proto::Scene scene;
        const auto read = read_json(text, "scene.json", scene);
        EXPECT_FALSE(read.has_value()) << text;
        return read ? std::string{} : read.error().detail;
    };
    EXPECT_EQ(told(R"({"content_exchang": {}})"),
              "scene.json: content_exchang: there is no such field; did you mean content_exchange?");
    EXPECT_EQ(told(R"({"content_exchange": {"asst": "x"}})"),
              "scene.json: content_exchange.asst: there is no such field; did you mean asset?");
    EXPECT_EQ(told(R"({"content_exchange": {"seed": -1}})"),
              "scene.json: content_exchange.seed: -1 is not a whole number, 0 or more");
    EXPECT_EQ(told(R"({"title": 1})"), "scene.json: title: 1 is not a text in quotes");
    EXPECT_EQ(told(R"({"title": ["a"]})"), "scene.json: title: is one value, and not a list");
    EXPECT_THAT(told(R"({"checker": {"zebra": 3}})"),
                HasSubstr("checker.zebra: there is no such field; there are "));
    EXPECT_THAT(told(R"({"title": )"), HasSubstr("scene.json: "));
}

TEST(Json, WhatIsWrittenIsReadBack) {
    proto::Scene scene, again;
    scene.set_title("Größe \"8\"");
    scene.mutable_content_exchange()->set_seed(1ull << 63);
    ASSERT_TRUE(read_json(write_json(scene), "scene.json", again).has_value());
    EXPECT_EQ(scene.SerializeAsString(), again.SerializeAsString());
}

TEST(Json, ABriefTextHoldsOnlyWhatIsSet) {
    proto::Scene scene, again;
    scene.mutable_content_exchange()->set_asset("asset");
    scene.mutable_content_exchange()->set_seed(3);
    const std::string brief = write_brief_json(scene);
    for (const char* unset : {"title", "extent_log2_pages", "attribution", "choice", "types", "unblended"}) {
        EXPECT_THAT(brief, Not(HasSubstr(unset)));
        EXPECT_THAT(write_json(scene), HasSubstr(unset));
    }
    ASSERT_TRUE(read_json(brief, "scene.json", again).has_value());
    EXPECT_EQ(scene.SerializeAsString(), again.SerializeAsString());
}

}  // namespace
}  // namespace tessera
