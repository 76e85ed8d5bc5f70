#include "client/link/background_stream_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/link/stream_listener.h"

namespace tessera {
namespace {

namespace asio = boost::asio;
using std::chrono::milliseconds;
using test::Listening;
using test::small_page;
using test::SmallStreamServer;
using test::StreamPeer;

/// Polls until `there` holds.
bool wait_until(BackgroundStreamClient& client, const std::function<bool()>& there) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (!there()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        client.wait_for_news(milliseconds{10});
    }
    return true;
}

proto::ServerMessage stale(std::uint64_t scene_revision, std::uint32_t level, std::int64_t x,
                           std::uint64_t revision) {
    proto::ServerMessage message;
    message.mutable_invalidation()->set_revision(scene_revision);
    proto::StalePages& pages = *message.mutable_invalidation()->add_stale();
    pages.set_level(level);
    pages.add_x(x);
    pages.add_y(0);
    pages.add_revision(revision);
    return message;
}

TEST(BackgroundStreamClient, BringsPagesAndMergesWhatBecameStale) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        const auto message = co_await peer.hear(proto::ClientMessage::kAsk);
        co_await peer.say(stale(8, 0, 3, 8));
        co_await peer.say(stale(9, 0, 3, 9));
        co_await peer.say(stale(9, 0, 64, 9));  // outside the extent
        co_await peer.say(stale(9, 60, 0, 9));
        co_await peer.say(stale(9, 0, -1, 9));
        co_await peer.say(small_page(message->ask().asks(0), 'p'));
        co_await peer.stay();
    }};
    BackgroundStreamClient client{server.address(), "checker", Listening::quick()};
    ASSERT_TRUE(wait_until(client, [&] { return client.status().open; }));
    client.allow(4);
    ASSERT_TRUE(client.ask({.id = 1, .page = {0, 3, 0}, .have = {}}));
    EXPECT_FALSE(client.ask({.id = 1, .page = {0, 4, 0}, .have = {}})) << "that id waits for its answer";
    std::vector<BackgroundStreamClient::Page> pages;
    ASSERT_TRUE(wait_until(client, [&] { return !(pages = client.take_pages()).empty(); }));
    EXPECT_TRUE(pages[0].page.texels);
    EXPECT_EQ(pages[0].history, 1u);
    const StreamNews news = client.take_news();
    EXPECT_EQ(news.history, 1u);
    EXPECT_EQ(news.told_revision, 9u);
    ASSERT_EQ(news.stale.size(), 1u);
    EXPECT_EQ(news.stale[0].page, (PageKey{0, 3, 0}));
    EXPECT_EQ(news.stale[0].revision, 9u);
    EXPECT_TRUE(client.take_news().stale.empty());
}

TEST(BackgroundStreamClient, NoMoreAsksAreOutThanTheCallerTakes) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        while (const auto message = co_await peer.hear(proto::ClientMessage::kAsk))
            for (const auto& ask : message->ask().asks()) co_await peer.say(small_page(ask, 'p'));
    }};
    StreamSettings settings = Listening::quick();
    settings.max_asks = 2;
    BackgroundStreamClient client{server.address(), "checker", settings};
    client.allow(4);
    ASSERT_TRUE(wait_until(client, [&] { return client.status().open; }));
    EXPECT_TRUE(client.ask({.id = 1, .page = {0, 1, 0}, .have = {}}));
    EXPECT_TRUE(client.ask({.id = 2, .page = {0, 2, 0}, .have = {}}));
    ASSERT_TRUE(wait_until(client, [&] { return client.status().statistics.pages == 2; }));
    EXPECT_FALSE(client.ask({.id = 3, .page = {0, 3, 0}, .have = {}})) << "two pages wait to be taken";
    EXPECT_EQ(client.take_pages(1).size(), 1u);
    EXPECT_TRUE(client.ask({.id = 3, .page = {0, 3, 0}, .have = {}}));
}

TEST(BackgroundStreamClient, TellsBreaksAndHistoriesApart) {
    SmallStreamServer server{[](StreamPeer& peer, int n) -> asio::awaitable<void> {
        // The first, the first resumed, the first which cannot tell what changed, another
        const std::function<void(proto::ServerHello&)> change = [n](proto::ServerHello& hello) {
            hello.set_resumed(n == 1);
            hello.set_revision(std::uint64_t{7} + static_cast<unsigned>(n));
            if (n == 3) hello.set_lineage("another");
        };
        co_await peer.greet(change);
        co_await peer.hear(proto::ClientMessage::kCredits);
        if (n == 3) co_await peer.stay();
    }};
    BackgroundStreamClient client{server.address(), "checker", Listening::quick()};
    std::vector<StreamNews> heard;
    client.allow(4);
    ASSERT_TRUE(wait_until(client, [&] {
        const StreamNews news = client.take_news();
        if (heard.empty() || news.newest_revision != heard.back().newest_revision) heard.push_back(news);
        return news.history == 2;
    }));
    EXPECT_EQ(heard.back().unsure_before, 0u) << "nothing is left of the old history to be unsure of";
    for (const StreamNews& news : heard) {
        if (news.newest_revision == 8) {
            EXPECT_EQ(news.unsure_before, 0u);
        } else if (news.newest_revision == 9) {
            EXPECT_EQ(news.unsure_before, 9u);
        }
    }
    EXPECT_TRUE(client.status().open);
    EXPECT_EQ(client.status().statistics.resumed, 1u);
}

TEST(BackgroundStreamClient, SaysWhatIsWrongAndEndsAtOnce) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> { co_await peer.stay(); },
                             [](int) {
                                 return std::string{
                                     "HTTP/1.1 503 Busy\r\nRetry-After: 60\r\n"
                                     "Content-Length: 0\r\n\r\n"};
                             }};
    BackgroundStreamClient client{server.address(), "checker", Listening::quick()};
    EXPECT_FALSE(client.ask({.id = 1, .page = {0, 1, 0}, .have = {}})) << "there is no connection";
    ASSERT_TRUE(wait_until(client, [&] { return !client.status().trouble.empty(); }));
    EXPECT_THAT(client.status().trouble, testing::HasSubstr("busy"));
    EXPECT_GT(client.status().retry_in, milliseconds{50'000});
}

TEST(BackgroundStreamClient, EditsEndWithTheirFates) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        while (const auto message = co_await peer.hear(proto::ClientMessage::kEdit)) {
            proto::ServerMessage done;
            done.mutable_edit_done()->set_id(message->edit().id());
            done.mutable_edit_done()->mutable_answer()->set_revision(8);
            co_await peer.say(done);
        }
    }};
    BackgroundStreamClient client{server.address(), "checker", Listening::quick()};
    const std::string id = client.edit({});
    std::vector<BackgroundStreamClient::Fate> fates;
    ASSERT_TRUE(wait_until(client, [&] { return !(fates = client.take_fates()).empty(); }));
    EXPECT_EQ(fates[0].id, id);
    EXPECT_EQ(std::get<proto::EditAnswer>(fates[0].fate).revision(), 8u);
}

}  // namespace
}  // namespace tessera
