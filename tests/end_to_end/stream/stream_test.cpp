// The stream over real sockets: the pages that a client asks for, and the beginning and end of a session.
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "tests/end_to_end/stream/live_server.h"

namespace tessera::test {
namespace {

using Case = proto::ServerMessage::MessageCase;
using namespace std::chrono_literals;

TEST(Stream, BeginsWithAHelloThatSaysWhatTheSceneIs) {
    LiveServer live;
    StreamClient client = live.stream();
    ASSERT_TRUE(client.open());
    const auto hello = client.hello();
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->scene(), "made");
    EXPECT_EQ(hello->title(), "Sprites of the tests");
    EXPECT_EQ(hello->revision(), 0u);
    EXPECT_EQ(hello->fingerprint(), live.now()->fingerprint);
    EXPECT_EQ(hello->lineage().size(), 36u);
    EXPECT_EQ(hello->extent_log2_pages(), 10u);
    EXPECT_GT(hello->session(), 0u);
    EXPECT_TRUE(hello->takes_edits());
    EXPECT_TRUE(hello->may_edit()) << hello->why_not();
    EXPECT_FALSE(hello->resumed());
    EXPECT_EQ(hello->patterns_size(), 4);
    EXPECT_EQ(hello->pattern_side_texels(), 16u);
    EXPECT_EQ(hello->limits().asks(), 1024u);

    StreamClient other = live.stream("grey");
    const auto still = other.hello();
    ASSERT_TRUE(still);
    EXPECT_FALSE(still->takes_edits());
    EXPECT_FALSE(still->may_edit());
    EXPECT_NE(still->why_not().find("sprites"), std::string::npos);
    EXPECT_NE(still->session(), hello->session());
}

TEST(Stream, SendsTheBytesThatHttpSends) {
    LiveServer live;
    RawClient http = live.http();
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    client.send(message_of(placing(1, 100, 100)));
    ASSERT_TRUE(client.receive(Case::kEditDone));
    client.grant(10);
    std::uint32_t id = 0;
    for (const std::string format : {"png", "rgba", "webp", "jpg"}) {
        proto::ClientMessage message;
        StreamClient::add_ask(message, ++id, 0, 0, 0);
        message.mutable_ask()->mutable_options()->set_format(format);
        message.mutable_ask()->mutable_options()->set_gutter(2);
        message.mutable_ask()->mutable_options()->set_plain(true);
        client.send(message);
        const auto answer = client.receive(Case::kPage);
        ASSERT_TRUE(answer);
        const proto::PageData& page = answer->page();
        const Reply reply = *http.get("/scenes/made/10/0/0." + format + "?gutter=2");
        EXPECT_EQ(reply.status, 200);
        EXPECT_EQ(page.texels(), reply.body) << format;
        EXPECT_EQ(page.id(), id);
        EXPECT_EQ(page.revision(), 1u);
        EXPECT_EQ(page.scene_revision(), 1u);
        EXPECT_FALSE(page.method().empty());

        // Whoever has it is told that it is right, and sent nothing
        message.mutable_ask()->mutable_asks(0)->set_have(page.tag());
        client.send(message);
        const auto again = client.receive(Case::kPage);
        ASSERT_TRUE(again);
        EXPECT_TRUE(again->page().unchanged());
        EXPECT_TRUE(again->page().texels().empty());
        EXPECT_EQ(again->page().tag(), page.tag());
    }
}

TEST(Stream, SendsAPageOfOneColourAsItsColour) {
    LiveServer live;
    StreamClient client = live.stream("grey");
    ASSERT_TRUE(client.hello());
    client.grant(1);
    client.ask(7, 3, 5, 6);
    const auto answer = client.receive(Case::kPage);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->page().colour(), 100u | 150u << 8 | 200u << 16 | 255u << 24);
    EXPECT_TRUE(answer->page().texels().empty());
    EXPECT_LT(client.last_bytes(), 100u);
}

TEST(Stream, SendsAsManyPagesAsThereAreCredits) {
    LiveServer live;
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    proto::ClientMessage message;
    for (std::uint32_t id = 0; id < 20; ++id) StreamClient::add_ask(message, id, 0, id, 3);
    client.send(message);
    EXPECT_FALSE(client.receive(Case::kPage, 100ms));
    std::set<std::uint32_t> got;
    for (const std::uint32_t credits : {1u, 3u, 16u}) {
        client.grant(credits);
        for (std::uint32_t i = 0; i < credits; ++i) {
            const auto page = client.receive(Case::kPage);
            ASSERT_TRUE(page);
            got.insert(page->page().id());
        }
        EXPECT_FALSE(client.receive(Case::kPage, 50ms));
    }
    EXPECT_EQ(got.size(), 20u);
}

TEST(Stream, AnswersTheMostUrgentFirst) {
    LiveServer live;
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    proto::ClientMessage message;
    for (std::uint32_t id = 0; id < 8; ++id) StreamClient::add_ask(message, id, 0, id, 3).set_urgency(7 - id);
    client.send(message);
    client.grant(8);
    for (int i = 0; i < 8; ++i) ASSERT_TRUE(client.receive(Case::kPage));
    // Now they are all in the cache, and only their order counts
    client.send(message);
    std::vector<std::uint32_t> order;
    for (int i = 0; i < 8; ++i) {
        client.grant(1);
        const auto page = client.receive(Case::kPage);
        ASSERT_TRUE(page);
        order.push_back(page->page().id());
    }
    EXPECT_EQ(order, (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(Stream, AnAskThatIsCancelledCostsNothing) {
    LiveServer live;
    StreamClient client = live.stream("gated");
    ASSERT_TRUE(client.hello());
    proto::ClientMessage message, cancel;
    for (std::uint32_t id = 0; id < 100; ++id) {
        StreamClient::add_ask(message, id, 0, id, 3);
        if (id != 50) cancel.mutable_cancel()->add_ids(id);
    }
    client.send(message);
    client.grant(1);
    ASSERT_TRUE(eventually([&] { return live.gated->begun >= 2; }));
    client.send(cancel);
    int cancelled = 0;
    while (cancelled < 99) {
        const auto refused = client.receive(Case::kRefused);
        ASSERT_TRUE(refused);
        EXPECT_EQ(refused->refused().why(), proto::PageRefusal::cancelled);
        ++cancelled;
    }
    live.gated->open();
    const auto page = client.receive(Case::kPage);
    ASSERT_TRUE(page);
    EXPECT_EQ(page->page().id(), 50u);
    // Begun were at most what the credits and the look-ahead allow, and the one that was wanted
    EXPECT_LE(live.gated->begun, 4);
}

TEST(Stream, RefusesAPageOfARevisionThatIsNotReached) {
    LiveServer live;
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    client.grant(5);
    proto::ClientMessage message;
    StreamClient::add_ask(message, 1, 0, 0, 0).set_least_revision(1);
    StreamClient::add_ask(message, 2, 11, 0, 0);
    StreamClient::add_ask(message, 3, 0, 1024, 0);
    StreamClient::add_ask(message, 4, 0, -1, 0);
    client.send(message);
    std::map<std::uint32_t, proto::PageRefusal::Why> why;
    for (int i = 0; i < 4; ++i) {
        const auto refused = client.receive(Case::kRefused);
        ASSERT_TRUE(refused);
        why[refused->refused().id()] = refused->refused().why();
    }
    EXPECT_EQ(why[1], proto::PageRefusal::not_yet);
    for (const std::uint32_t id : {2u, 3u, 4u}) EXPECT_EQ(why[id], proto::PageRefusal::wrong) << id;
    client.send(message_of(placing(1, 100, 100)));
    ASSERT_TRUE(client.receive(Case::kEditDone));
    message.mutable_ask()->mutable_asks()->DeleteSubrange(1, 3);
    client.send(message);
    const auto page = client.receive(Case::kPage);
    ASSERT_TRUE(page);
    EXPECT_GE(page->page().scene_revision(), 1u);
}

TEST(Stream, PagesOfASceneThatMovesSayInWhichStepsTheyAreRight) {
    LiveServer live;
    StreamClient client = live.stream("moving");
    const auto hello = client.hello();
    ASSERT_TRUE(hello);
    EXPECT_TRUE(hello->animated());
    EXPECT_EQ(hello->clock().steps_per_second(), 4);
    EXPECT_EQ(hello->clock().loop_steps(), 100);
    EXPECT_TRUE(hello->clock().playing());
    client.grant(10);
    const auto page_at = [&](std::int64_t step, const std::string& have) {
        proto::ClientMessage message;
        proto::PageAsk& ask = StreamClient::add_ask(message, 1, 0, 0, 0);
        ask.set_step(step);
        ask.set_have(have);
        client.send(message);
        return client.receive(Case::kPage).value().page();
    };
    const proto::PageData first = page_at(13, {});
    EXPECT_EQ(first.from(), 10);
    EXPECT_EQ(first.until(), 20);
    EXPECT_FALSE(first.texels().empty());
    EXPECT_TRUE(page_at(19, first.tag()).unchanged());
    const proto::PageData second = page_at(20, first.tag());
    EXPECT_FALSE(second.unchanged());
    EXPECT_EQ(second.from(), 20);
    EXPECT_NE(second.tag(), first.tag());
    EXPECT_NE(second.texels(), first.texels());
    EXPECT_EQ(page_at(15, {}).texels(), first.texels());
}

TEST(Stream, IsSeenByPrometheus) {
    LiveServer live;
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    client.grant(2);
    client.ask(1, 0, 0, 0);
    ASSERT_TRUE(client.receive(Case::kPage));
    client.send(message_of(placing(1, 100, 100)));
    ASSERT_TRUE(client.receive(Case::kEditDone));
    const std::string metrics = live.http().get("/metrics")->body;
    for (const char* line :
         {"tessera_streams 1\n", "tessera_stream_pages_total 1\n", "tessera_stream_edits_total 1\n",
          "tessera_http_answers_total{status=\"101\"} 1\n", "tessera_http_connections 2\n"})
        EXPECT_NE(metrics.find(line), std::string::npos) << line;
}

TEST(Stream, SaysGoodbyeWhenTheServerStops) {
    LiveServer live;
    StreamClient client = live.stream(), silent = live.stream();
    ASSERT_TRUE(client.hello());
    std::jthread stopping{[&] { live.server->stop(); }};
    const auto goodbye = client.receive(Case::kGoodbye);
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->goodbye().why(), proto::Goodbye::stopping);
    EXPECT_FALSE(client.receive());
    EXPECT_EQ(client.reason().code, boost::beast::websocket::close_code::going_away);
    const auto begun = std::chrono::steady_clock::now();
    stopping.join();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 3s);
}

}  // namespace
}  // namespace tessera::test
