#include "client/link/background_gets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/link/small_server.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using test::SmallServer;

std::vector<BackgroundGets::Got> wait_for(BackgroundGets& gets, std::size_t count) {
    std::vector<BackgroundGets::Got> all;
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (all.size() < count && std::chrono::steady_clock::now() < end) {
        for (BackgroundGets::Got& got : gets.take(2)) all.push_back(std::move(got));
        std::this_thread::sleep_for(1ms);
    }
    return all;
}

TEST(BackgroundGets, BringsWhatWasAskedForInOrderWhateverBecomesOfEach) {
    const SmallServer server{[](const SmallServer::Request& request) -> SmallServer::Answer {
        const std::string target{request.target()};
        if (target == "/gone") return {.status = 404, .body = "no such thing"};
        if (target == "/garbage") return {.raw = "this is no HTTP\r\n\r\n"};
        return {.body = "of " + target};
    }};
    BackgroundGets gets{server.address()};
    for (const char* target : {"/a", "/gone", "/garbage", "/b"}) ASSERT_TRUE(gets.ask(target));
    const auto all = wait_for(gets, 4);
    ASSERT_EQ(all.size(), 4u);
    EXPECT_EQ(all[0].target, "/a");
    ASSERT_TRUE(all[0].reply);
    EXPECT_EQ(all[0].reply->body, "of /a");
    ASSERT_TRUE(all[1].reply);
    EXPECT_EQ(all[1].reply->status, 404u);
    EXPECT_FALSE(all[2].reply);
    ASSERT_TRUE(all[3].reply) << "a broken connection is made again";
    EXPECT_EQ(all[3].reply->body, "of /b");
}

TEST(BackgroundGets, TakesNoMoreThanItsCallerFetches) {
    const SmallServer server{[](const SmallServer::Request&) { return SmallServer::Answer{.body = "x"}; }};
    BackgroundGets gets{server.address()};
    int taken = 0;
    while (gets.ask("/" + std::to_string(taken)) && taken < 1000) ++taken;
    EXPECT_EQ(taken, 64);
    ASSERT_EQ(wait_for(gets, 64).size(), 64u);
    EXPECT_TRUE(gets.ask("/again"));
}

TEST(BackgroundGets, EndsAtOnceWhileAnAnswerIsAwaited) {
    const SmallServer server{
        [](const SmallServer::Request&) { return SmallServer::Answer{.body = "late", .delay = 8s}; }};
    const auto begin = std::chrono::steady_clock::now();
    {
        BackgroundGets gets{server.address()};
        ASSERT_TRUE(gets.ask("/late"));
        ASSERT_TRUE(gets.ask("/never"));
        std::this_thread::sleep_for(50ms);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 6s);
}

TEST(BackgroundGets, SaysThatNobodyListens) {
    ServerAddress nobody;
    {
        const SmallServer gone{[](const SmallServer::Request&) { return SmallServer::Answer{}; }};
        nobody = gone.address();
    }
    BackgroundGets gets{nobody};
    ASSERT_TRUE(gets.ask("/a"));
    const auto all = wait_for(gets, 1);
    ASSERT_EQ(all.size(), 1u);
    ASSERT_FALSE(all[0].reply);
    EXPECT_THAT(all[0].reply.error().detail, ::testing::HasSubstr("127.0.0.1"));
}

}  // namespace
}  // namespace tessera
