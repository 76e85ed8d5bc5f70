// What a server says of pages, right and wrong.
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
using testing::HasSubstr;

constexpr std::size_t page_bytes = std::size_t{4} * 256 * 256;

/// Answers each ask by what `answers` makes of it.
using Answers = std::function<std::vector<proto::ServerMessage>(const proto::PageAsk&)>;
SmallStreamServer::Script answering(Answers answers) {
    return [answers](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        while (const auto message = co_await peer.hear(proto::ClientMessage::kAsk))
            for (const proto::PageAsk& ask : message->ask().asks())
                for (const proto::ServerMessage& answer : answers(ask)) co_await peer.say(answer);
    };
}

TEST(StreamPages, APageComesUnpackedWithItsRevisionAndValidity) {
    SmallStreamServer server{answering([](const proto::PageAsk& ask) {
        proto::ServerMessage message = small_page(ask, 'p', 9);
        message.mutable_page()->set_from(-5);
        message.mutable_page()->set_until(20);
        return std::vector{message};
    })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 4, .page = {1, 2, 3}, .step = 19, .least_revision = 8, .have = {}}});
    ASSERT_TRUE(listening.wait_for_pages(1));
    const StreamPage& page = listening.pages[0];
    ASSERT_TRUE(page.texels) << page.texels.error().detail;
    EXPECT_EQ(*page.texels, std::string(page_bytes, 'p'));
    EXPECT_EQ(page.id, 4u);
    EXPECT_EQ(page.page, (PageKey{1, 2, 3}));
    EXPECT_EQ(page.revision, 9u);
    EXPECT_EQ(page.validity, (Validity{-5, 20}));
    EXPECT_EQ(page.tag, "tag");
    EXPECT_EQ(listening.client->statistics().mistakes, 0u);
}

TEST(StreamPages, APageOfOneColourIsFilledWithIt) {
    SmallStreamServer server{answering([](const proto::PageAsk& ask) {
        proto::ServerMessage message = small_page(ask, 'p');
        message.mutable_page()->clear_texels();
        message.mutable_page()->set_colour(0x44332211);
        return std::vector{message};
    })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}}});
    ASSERT_TRUE(listening.wait_for_pages(1));
    ASSERT_TRUE(listening.pages[0].texels);
    EXPECT_EQ(listening.pages[0].texels->size(), page_bytes);
    EXPECT_EQ(listening.pages[0].texels->substr(page_bytes - 4), "\x11\x22\x33\x44");
}

TEST(StreamPages, AnUnchangedPageIsTakenOnlyForTheCopyThatTheAskerHas) {
    SmallStreamServer server{answering([](const proto::PageAsk& ask) {
        proto::ServerMessage message = small_page(ask, 'p');
        message.mutable_page()->clear_texels();
        message.mutable_page()->set_unchanged(true);
        return std::vector{message};
    })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = "tag"},
                             {.id = 2, .page = {0, 1, 0}, .have = "another"},
                             {.id = 3, .page = {0, 2, 0}, .have = {}}});
    ASSERT_TRUE(listening.wait_for_pages(3));
    EXPECT_TRUE(listening.pages[0].texels && listening.pages[0].unchanged);
    EXPECT_FALSE(listening.pages[1].texels);
    EXPECT_FALSE(listening.pages[2].texels);
}

/// What the client makes of one page after `spoil` changed it.
StreamPage page_after(const std::function<void(proto::PageData&)>& spoil) {
    SmallStreamServer server{answering([&](const proto::PageAsk& ask) {
        proto::ServerMessage message = small_page(ask, 'p');
        spoil(*message.mutable_page());
        return std::vector{message};
    })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 5, 6}, .step = 3, .least_revision = 7, .have = {}}});
    if (!listening.wait_for_pages(1)) return failed_page({}, {ErrorCode::timed_out, "no page came"});
    EXPECT_TRUE(listening.lost.empty()) << "one mistake is no reason to leave";
    EXPECT_EQ(listening.client->statistics().mistakes, 1u);
    return listening.pages[0];
}

TEST(StreamPages, AWrongPageIsNamedAndTheStreamGoesOn) {
    const auto problem = [](const std::function<void(proto::PageData&)>& spoil) {
        const StreamPage page = page_after(spoil);
        EXPECT_FALSE(page.texels);
        return page.texels ? std::string{} : page.texels.error().detail;
    };
    EXPECT_THAT(problem([](auto& page) { page.mutable_page()->set_x(7); }), HasSubstr("another page"));
    EXPECT_THAT(problem([](auto& page) { page.mutable_page()->set_level(1); }), HasSubstr("another page"));
    EXPECT_THAT(problem([](auto& page) { page.mutable_texels()->resize(20); }), HasSubstr("zstd"));
    EXPECT_THAT(problem([](auto& page) { page.clear_texels(); }), HasSubstr("zstd"));
    EXPECT_THAT(problem([](auto& page) { page.set_texels("garbage"); }), HasSubstr("zstd"));
    EXPECT_THAT(problem([](auto& page) { page.set_scene_revision(6); }), HasSubstr("revision 6"));
    EXPECT_THAT(problem([](auto& page) { page.set_revision(99); }), HasSubstr("newer than its scene"));
    EXPECT_THAT(problem([](auto& page) { page.set_until(3); }), HasSubstr("other steps"));
    EXPECT_THAT(problem([](auto& page) { page.set_tag(std::string(300, 't')); }), HasSubstr("tag"));
}

TEST(StreamPages, APageOfAnotherSizeIsRefusedWithoutBeingUnpackedWhole) {
    Listening* waiting = nullptr;
    SmallStreamServer server{answering([](const proto::PageAsk& ask) {
        return std::vector{small_page(ask, 'p')};  // has no gutter
    })};
    StreamSettings settings = Listening::quick();
    settings.options.gutter = 4;
    Listening wide{server.address(), settings};
    waiting = &wide;
    waiting->ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}}});
    ASSERT_TRUE(wide.wait_for_pages(1));
    ASSERT_FALSE(wide.pages[0].texels);
    EXPECT_THAT(wide.pages[0].texels.error().detail, HasSubstr("262144 bytes where the page has 278784"));
}

TEST(StreamPages, ReorderedAnswersFindTheirAsksAndDoubledOnesAreDropped) {
    std::vector<proto::PageAsk> held;
    SmallStreamServer server{answering([&](const proto::PageAsk& ask) {
        std::vector<proto::ServerMessage> answers;
        held.push_back(ask);
        if (held.size() < 3) return answers;
        for (auto late = held.rbegin(); late != held.rend(); ++late) {
            answers.push_back(small_page(*late, static_cast<char>('a' + late->id())));
            answers.push_back(answers.back());
        }
        answers.push_back(small_page(ask, 'x'));
        answers.back().mutable_page()->set_id(1000);
        return answers;
    })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}},
                             {.id = 2, .page = {0, 1, 0}, .have = {}},
                             {.id = 3, .page = {0, 2, 0}, .have = {}}});
    ASSERT_TRUE(listening.run_until([&] { return listening.client->statistics().mistakes >= 4; }));
    ASSERT_EQ(listening.pages.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(listening.pages[i].id, 3 - i);
        EXPECT_EQ(listening.pages[i].texels->front(), static_cast<char>('a' + 3 - i));
    }
    EXPECT_TRUE(listening.lost.empty());
}

TEST(StreamPages, AServerThatMakesMistakesWithoutEndIsLeft) {
    SmallStreamServer server{
        answering([](const proto::PageAsk& ask) { return std::vector(100, small_page(ask, 'p')); })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}}});
    ASSERT_TRUE(listening.run_until([&] { return !listening.lost.empty(); }));
    EXPECT_THAT(listening.lost[0].detail, HasSubstr("64 mistakes"));
}

TEST(StreamPages, NoMorePagesAreGrantedThanAllowed) {
    std::uint32_t granted = 0;
    SmallStreamServer server{[&](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        while (const auto message = co_await peer.hear()) {
            granted += message->credits().pages();
            for (const proto::PageAsk& ask : message->ask().asks())
                if (ask.id() <= 6) co_await peer.say(small_page(ask, 'p'));
        }
    }};
    Listening listening{server.address()};
    listening.when_open = [&] {
        listening.client->allow(8);
        for (std::uint32_t id = 1; id <= 20; ++id)
            listening.client->ask({.id = id, .page = {0, id, 0}, .have = {}});
    };
    ASSERT_TRUE(listening.wait_for_pages(6));
    listening.run_for(milliseconds{50});
    EXPECT_LE(granted, 6u + 8u);
    EXPECT_GE(granted, 6u + 4u);
    EXPECT_EQ(listening.client->statistics().credits, std::int64_t{granted} - 6);
}

TEST(StreamPages, ACancelledAskEndsOnceWhetherItWasSentOrNot) {
    SmallStreamServer server{[&](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        while (const auto message = co_await peer.hear(proto::ClientMessage::kCancel))
            for (const std::uint32_t id : message->cancel().ids()) {
                proto::ServerMessage refusal;
                refusal.mutable_refused()->set_id(id);
                refusal.mutable_refused()->set_why(proto::PageRefusal::cancelled);
                co_await peer.say(refusal);
            }
    }};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}}});
    ASSERT_TRUE(listening.run_until([&] { return !listening.hellos.empty(); }));
    listening.run_for(milliseconds{30});
    listening.client->cancel(1);
    listening.client->ask({.id = 2, .page = {0, 1, 0}, .have = {}});
    listening.client->cancel(2);
    EXPECT_TRUE(listening.pages.empty()) << "no call from within a call";
    ASSERT_TRUE(listening.wait_for_pages(2));
    listening.client->cancel(1);
    listening.run_for(milliseconds{50});
    ASSERT_EQ(listening.pages.size(), 2u);
    for (const StreamPage& page : listening.pages) EXPECT_EQ(page.texels.error().code, ErrorCode::cancelled);
}

TEST(StreamPages, ARefusalSaysWhenToAskAgain) {
    SmallStreamServer server{answering([](const proto::PageAsk& ask) {
        proto::ServerMessage message;
        message.mutable_refused()->set_id(ask.id());
        message.mutable_refused()->set_why(static_cast<proto::PageRefusal::Why>(ask.id()));
        message.mutable_refused()->set_retry_ms(250);
        return std::vector{message};
    })};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 0, .page = {0, 0, 0}, .have = {}},
                             {.id = 2, .page = {0, 1, 0}, .have = {}},
                             {.id = 5, .page = {0, 2, 0}, .have = {}}});
    ASSERT_TRUE(listening.wait_for_pages(3));
    EXPECT_EQ(listening.pages[0].texels.error().code, ErrorCode::malformed_request);
    EXPECT_EQ(listening.pages[1].texels.error().code, ErrorCode::overloaded);
    EXPECT_EQ(listening.pages[1].retry_ms, 250u);
    EXPECT_EQ(listening.pages[2].texels.error().code, ErrorCode::overloaded);
}

TEST(StreamPages, AnAskWithoutAnAnswerTimesOutAndItsLateAnswerIsDropped) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        const auto message = co_await peer.hear(proto::ClientMessage::kAsk);
        co_await peer.hear(proto::ClientMessage::kCancel);
        co_await peer.say(small_page(message->ask().asks(0), 'p'));
        co_await peer.stay();
    }};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}}});
    ASSERT_TRUE(listening.wait_for_pages(1));
    EXPECT_EQ(listening.pages[0].texels.error().code, ErrorCode::timed_out);
    ASSERT_TRUE(listening.run_until([&] { return listening.client->statistics().asks == 0; }));
    EXPECT_EQ(listening.pages.size(), 1u);
    EXPECT_EQ(listening.client->statistics().mistakes, 0u);
}

/// Four asks that get no answer in time, of a client that has room for four.
struct SlowDay {
    explicit SlowDay(bool drops, milliseconds cancel_timeout)
        : server{[drops](StreamPeer& peer, int) -> asio::awaitable<void> {
              co_await peer.greet();
              while (const auto message = co_await peer.hear(proto::ClientMessage::kCancel))
                  for (const std::uint32_t id : message->cancel().ids()) {
                      proto::ServerMessage refusal;
                      refusal.mutable_refused()->set_id(id);
                      refusal.mutable_refused()->set_why(proto::PageRefusal::cancelled);
                      if (drops) co_await peer.say(refusal);
                  }
          }},
          listening{server.address(), settings(cancel_timeout)} {
        listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}},
                                 {.id = 2, .page = {0, 1, 0}, .have = {}},
                                 {.id = 3, .page = {0, 2, 0}, .have = {}},
                                 {.id = 4, .page = {0, 3, 0}, .have = {}}});
    }
    static StreamSettings settings(milliseconds cancel_timeout) {
        StreamSettings settings = Listening::quick();
        settings.max_asks = 4;
        settings.answer_timeout = milliseconds{100};
        settings.cancel_timeout = cancel_timeout;
        settings.limits.silence_timeout = milliseconds{20000};  // pings are not what is looked at
        return settings;
    }
    SmallStreamServer server;
    Listening listening;
};

TEST(StreamPages, AServerThatIsMerelySlowIsNotLeftHoweverManyAsksItKeepsWaiting) {
    SlowDay day{true, milliseconds{8000}};
    ASSERT_TRUE(day.listening.wait_for_pages(4));
    for (const StreamPage& page : day.listening.pages)
        EXPECT_EQ(page.texels.error().code, ErrorCode::timed_out);
    ASSERT_TRUE(day.listening.run_until([&] { return day.listening.client->statistics().asks == 0; }));
    day.listening.run_for(milliseconds{250});
    EXPECT_TRUE(day.listening.lost.empty());
}

TEST(StreamPages, AServerThatDoesNotEvenSayThatItDroppedAsksIsLeft) {
    SlowDay day{false, milliseconds{150}};
    ASSERT_TRUE(day.listening.run_until([&] { return !day.listening.lost.empty(); }));
    EXPECT_THAT(day.listening.lost[0].detail, HasSubstr("most asks for pages without an answer"));
}

}  // namespace
}  // namespace tessera
