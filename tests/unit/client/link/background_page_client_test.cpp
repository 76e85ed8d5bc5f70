#include "client/link/background_page_client.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/client/link/small_server.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using test::SmallServer;
using Answer = SmallServer::Answer;

SceneInfo checker_info() {
    SceneInfo info;
    info.id = "checker";
    info.extent.n = 10;
    info.max_gutter = 16;
    return info;
}

TEST(BackgroundPageClient, HandsOutFinishedPagesWithoutWaiting) {
    SmallServer server{
        [](const SmallServer::Request&) { return Answer{.body = std::string(4 * 258 * 258, 'x')}; }};
    BackgroundPageClient client{server.address(), checker_info()};
    std::set<RequestId> asked;
    for (std::uint32_t x = 0; x < 40; ++x) asked.insert(client.request({.x = x}, {.gutter = 1}).value());
    EXPECT_EQ(asked.size(), 40u);
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    while (!asked.empty() && std::chrono::steady_clock::now() < deadline) {
        client.wait_for_finished(100ms);
        for (const FinishedPage& finished : client.take_finished(3)) {
            ASSERT_TRUE(finished.result) << finished.result.error().detail;
            EXPECT_EQ(finished.result->page, finished.page);
            EXPECT_EQ(asked.erase(finished.id), 1u);
        }
    }
    EXPECT_TRUE(asked.empty());
    EXPECT_EQ(client.outstanding(), 0u);
    EXPECT_EQ(client.statistics().succeeded, 40u);
}

TEST(BackgroundPageClient, BoundsWhatIsOutstandingAndCancels) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.delay = 10s}; }};
    BackgroundPageClient client{server.address(), checker_info(), {}, 4};
    std::vector<RequestId> ids;
    for (std::uint32_t x = 0; x < 4; ++x) ids.push_back(client.request({.x = x}).value());
    EXPECT_EQ(client.request({.x = 5}), std::nullopt);
    client.cancel(ids[1]);
    ASSERT_TRUE(client.wait_for_finished(5s));
    const auto finished = client.take_finished();
    ASSERT_EQ(finished.size(), 1u);
    EXPECT_EQ(finished[0].id, ids[1]);
    EXPECT_EQ(finished[0].result.error().code, ErrorCode::cancelled);
    EXPECT_TRUE(client.request({.x = 5}).has_value());
    // The destructor does not wait for the server's ten seconds
}

}  // namespace
}  // namespace tessera
