#include "client/link/scene_info.h"

#include <atomic>
#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/link/small_server.h"

namespace tessera {
namespace {

using test::SmallServer;
using ::testing::HasSubstr;

TEST(SceneInfo, ComesFromTileJsonAndSkipsWhatItDoesNotKnow) {
    SmallServer server{[](const SmallServer::Request& request) {
        EXPECT_EQ(request.target(), "/scenes/checker");
        return SmallServer::Answer{.body = test::small_tile_json(12)};
    }};
    const auto info = read_scene_info(server.address(), "checker");
    ASSERT_TRUE(info) << info.error().detail;
    EXPECT_EQ(info->id, "checker");
    EXPECT_EQ(info->title, "A checker");
    EXPECT_EQ(info->extent, Extent{12});
    EXPECT_EQ(info->max_gutter, 8);
    EXPECT_EQ(info->revision, 7u);
    EXPECT_EQ(info->fingerprint, "abc");
    EXPECT_THAT(info->formats, ::testing::ElementsAre("png", "rgba"));
    EXPECT_THAT(info->channels, ::testing::ElementsAre("albedo"));  // this server names none
}

TEST(SceneInfo, NamesTheChannelSets) {
    const auto info = parse_scene_info(
        R"({"tessera": {"id": "a", "page_side": 256, "channels": ["albedo", "normal"]}})", "here");
    ASSERT_TRUE(info) << info.error().detail;
    EXPECT_THAT(info->channels, ::testing::ElementsAre("albedo", "normal"));
    EXPECT_TRUE(check_channels(*info, ChannelSet::normal));
    EXPECT_THAT(check_channels(*info, ChannelSet::height).error().detail, HasSubstr("it has albedo, normal"));
}

TEST(SceneInfo, SaysWhetherAnythingMovesSoThatAStepCanBeAskedFor) {
    const auto info_of = [](const std::string& more) {
        return parse_scene_info(R"({"tessera": {"id": "a", "page_side": 256)" + more + "}}", "here").value();
    };
    const SceneInfo still = info_of(""), moving = info_of(R"(, "animated": true)");
    EXPECT_TRUE(check_step(moving, 7));
    EXPECT_TRUE(check_step(moving, -7));
    EXPECT_TRUE(check_step(still, 0));
    EXPECT_THAT(check_step(still, 7).error().detail, HasSubstr("--step: nothing moves in scene a"));
}

TEST(SceneInfo, HasTheOpeningViewThatAServerTells) {
    const auto view_of = [](const std::string& view) {
        return parse_scene_info(
                   R"({"tessera": {"id": "a", "page_side": 256, "extent_log2_pages": 2)" + view + "}}",
                   "here")
            .value()
            .view;
    };
    EXPECT_EQ(view_of(""), std::nullopt);
    EXPECT_EQ(view_of(R"(, "view": {"x": "7", "y": 9, "level": -1.5})"), (OpeningView{7, 9, -1.5}));
    EXPECT_EQ(view_of(R"(, "view": {"x": "-7", "y": "99999999999", "level": "Infinity"})"),
              (OpeningView{0, 1023, 1}))
        << "another server's mistake ends inside the extent";
}

TEST(SceneInfo, NamesTheScenesThereAreIfTheOneAskedForIsNotAmongThem) {
    SmallServer server{[](const SmallServer::Request& request) {
        if (request.target() == "/scenes")
            return SmallServer::Answer{.body = R"({"scenes": [{"id": "pebbles"}, {"id": "stones"}]})"};
        return SmallServer::Answer{.status = 404};
    }};
    const auto info = read_scene_info(server.address(), "peebles");
    ASSERT_FALSE(info);
    EXPECT_EQ(info.error().code, ErrorCode::no_such_scene);
    EXPECT_THAT(info.error().detail, HasSubstr("pebbles, stones"));
}

TEST(SceneInfo, IsWaitedForWhileTheServerLoadsItsScenes) {
    std::atomic<int> asked = 0;
    SmallServer server{[&](const SmallServer::Request&) {
        return ++asked < 3 ? SmallServer::Answer{.status = 503}
                           : SmallServer::Answer{.body = test::small_tile_json(12)};
    }};
    int told = 0;
    const auto info =
        await_scene_info(server.address(), "checker", std::chrono::seconds{60}, [&] { ++told; });
    ASSERT_TRUE(info) << info.error().detail;
    EXPECT_EQ(asked, 3);
    EXPECT_EQ(told, 1);
}

TEST(SceneInfo, IsNotWaitedForLongerThanPatienceNorWhereThereIsNone) {
    std::atomic<unsigned> status = 503;
    SmallServer server{[&](const SmallServer::Request&) { return SmallServer::Answer{.status = status}; }};
    const auto ask = [&](std::chrono::milliseconds patience) {
        return await_scene_info(server.address(), "checker", patience, [] {}).error().code;
    };
    EXPECT_EQ(ask(std::chrono::milliseconds{100}), ErrorCode::overloaded);
    status = 404;
    EXPECT_EQ(ask(std::chrono::hours{1}), ErrorCode::no_such_scene);
}

TEST(SceneInfo, RefusesWhatIsNoTesseraServerAndPagesItCannotShow) {
    EXPECT_THAT(parse_scene_info("<html>", "x").error().detail, HasSubstr("x:"));
    EXPECT_THAT(parse_scene_info(R"({"tilejson": "3.0.0"})", "x").error().detail,
                HasSubstr("'tessera' is missing"));
    EXPECT_THAT(parse_scene_info(R"({"tessera": {"page_side": 512}})", "x").error().detail,
                HasSubstr("page_side"));
    EXPECT_THAT(
        parse_scene_info(R"({"tessera": {"page_side": 256, "extent_log2_pages": 31}})", "x").error().detail,
        HasSubstr("extent_log2_pages"));
}

TEST(SceneInfo, SaysThatNobodyListens) {
    std::uint16_t port = 0;
    {
        SmallServer server{[](const SmallServer::Request&) { return SmallServer::Answer{}; }};
        port = server.address().port;
    }
    const auto info = read_scene_info({"127.0.0.1", port}, "checker");
    ASSERT_FALSE(info);
    EXPECT_EQ(info.error().code, ErrorCode::io_failure);
    EXPECT_THAT(info.error().detail, HasSubstr("is the server running"));
}

}  // namespace
}  // namespace tessera
