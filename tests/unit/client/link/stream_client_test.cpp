// Connections: how they are lost, and what is made of it.
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/link/stream_listener.h"

namespace tessera {
namespace {

namespace asio = boost::asio;
using std::chrono::milliseconds;
using test::Listening;
using test::SmallStreamServer;
using test::StreamPeer;
using testing::AnyOf;
using testing::HasSubstr;

/// How a client loses a server that greets it and then does this, while an ask waits.
Error lost_by(SmallStreamServer::Script then) {
    SmallStreamServer server{[then](StreamPeer& peer, int n) -> asio::awaitable<void> {
        co_await peer.greet();
        co_await peer.hear(proto::ClientMessage::kAsk);
        co_await then(peer, n);
    }};
    Listening listening{server.address()};
    listening.ask_when_open({{.id = 1, .page = {0, 0, 0}, .have = {}}});
    if (!listening.run_until([&] { return !listening.lost.empty(); }))
        return {ErrorCode::invalid_input, "it never lost the server"};
    EXPECT_EQ(listening.pages.size(), 1u) << "an ask ends with its connection";
    EXPECT_TRUE(listening.pages.empty() || !listening.pages[0].texels);
    EXPECT_TRUE(listening.run_until([&] { return listening.hellos.size() > 1; })) << "it comes back";
    return listening.lost[0];
}

TEST(StreamClient, SaysHowItLostTheServerAndComesBack) {
    const auto closing = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        boost::system::error_code ignored;
        peer.stream.next_layer().close(ignored);
        co_return;
    };
    EXPECT_THAT(lost_by(closing).detail, HasSubstr("the server closed the connection"));
    const auto garbage = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.say_bytes("\xff\xff\xff garbage");
        co_await peer.stay();
    };
    EXPECT_THAT(lost_by(garbage).detail, HasSubstr("no message of proto/stream.proto"));
    const auto raw_garbage = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.say_raw("HTTP/1.1 500 What?\r\n\r\n");
        co_await peer.stay();
    };
    EXPECT_EQ(lost_by(raw_garbage).code, ErrorCode::io_failure);
    const auto text = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        peer.stream.text(true);
        co_await peer.say_bytes("hello");
        co_await peer.stay();
    };
    EXPECT_THAT(lost_by(text).detail, HasSubstr("text"));
    const auto leaving = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        proto::ServerMessage goodbye;
        goodbye.mutable_goodbye()->set_why(proto::Goodbye::stopping);
        goodbye.mutable_goodbye()->set_detail("back in a minute");
        co_await peer.say(goodbye);
        co_await peer.stay();
    };
    EXPECT_THAT(lost_by(leaving).detail, HasSubstr("the server stops: back in a minute"));
    // A binary frame that says it has 1 GiB
    const auto huge = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.say_raw(std::string{"\x82\x7f\x00\x00\x00\x00\x40\x00\x00\x00", 10});
        co_await peer.stay();
    };
    EXPECT_THAT(lost_by(huge).detail, HasSubstr("more than 4194304 bytes"));
}

TEST(StreamClient, DoesNotWaitForEverInTheMiddleOfAMessage) {
    const auto half = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.say_raw(std::string{"\x82\x7e\x01\x00half of it", 14});
        boost::system::error_code ignored;
        peer.stream.next_layer().close(ignored);
    };
    EXPECT_THAT(lost_by(half).detail, HasSubstr("closed the connection"));
    // Bytes that drip in are signs of life, and no message
    const auto dripping = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.say_raw(std::string{"\x82\x7e\x01\x00", 4});
        for (int i = 0; i < 200; ++i) {
            co_await peer.say_raw(".");
            co_await peer.wait(milliseconds{10});
        }
    };
    const Error dripped = lost_by(dripping);
    EXPECT_EQ(dripped.code, ErrorCode::timed_out);
    EXPECT_THAT(dripped.detail, HasSubstr("not complete within 400 ms"));
    const auto half_a_head = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.say_raw("\x82");
        co_await peer.wait(milliseconds{2000});
    };
    EXPECT_THAT(lost_by(half_a_head).detail, HasSubstr("nothing was heard"));
    const auto silent = [](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.wait(milliseconds{2000});
    };
    EXPECT_EQ(lost_by(silent).code, ErrorCode::timed_out);
}

TEST(StreamClient, LeavesAServerThatTakesNothing) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        for (int i = 0; i < 300; ++i) {  // it speaks, but does not listen
            co_await peer.say({});
            co_await peer.wait(milliseconds{10});
        }
    }};
    Listening listening{server.address()};
    int refused = 0;
    listening.when_open = [&] {
        for (int i = 0; i < 200; ++i) {
            proto::Edit edit;
            edit.add_changes()->mutable_paint_map()->set_values(std::string(150'000, 'v'));
            listening.client->edit(edit, [&](const EditFate&) { ++refused; });
        }
    };
    ASSERT_TRUE(listening.run_until([&] { return !listening.lost.empty(); }));
    EXPECT_THAT(listening.lost[0].detail, HasSubstr("did not take a message"));
    EXPECT_EQ(refused, 0) << "their fate is open";
}

/// How a client fails to open a stream with a server that answers this to the upgrade.
std::pair<Error, milliseconds> refused_with(const std::string& answer) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> { co_await peer.greet(); },
                             [&](int) { return answer; }};
    Listening listening{server.address()};
    if (!listening.run_until([&] { return !listening.lost.empty(); }))
        return {{ErrorCode::invalid_input, "nothing was lost"}, {}};
    EXPECT_TRUE(listening.hellos.empty());
    return {listening.lost[0], listening.waits[0]};
}

TEST(StreamClient, SaysWhyItsUpgradeWasRefusedAndWaitsAsItWasTold) {
    const auto [busy, wait] =
        refused_with("HTTP/1.1 503 Busy\r\nRetry-After: 7\r\nContent-Length: 12\r\n\r\ntoo many now");
    EXPECT_EQ(busy.code, ErrorCode::overloaded);
    EXPECT_THAT(busy.detail, HasSubstr("too many now"));
    EXPECT_EQ(wait, milliseconds{7000});
    const auto [gone, soon] = refused_with("HTTP/1.1 404 Gone\r\nContent-Length: 0\r\n\r\n");
    EXPECT_EQ(gone.code, ErrorCode::no_such_scene);
    EXPECT_LE(soon, milliseconds{20});
    EXPECT_EQ(refused_with("HTTP/1.1 403 No\r\nContent-Length: 0\r\n\r\n").first.code,
              ErrorCode::malformed_request);
    EXPECT_THAT(refused_with("HTTP/1.1 200 Fine\r\nContent-Length: 0\r\n\r\n").first.detail,
                HasSubstr("opens no stream there"));
    EXPECT_EQ(refused_with("no HTTP at all\r\n\r\n").first.code, ErrorCode::io_failure);
    EXPECT_EQ(refused_with("HTTP/1.1 101 Half").first.code, ErrorCode::io_failure);
    EXPECT_EQ(refused_with("HTTP/1.1 503 Busy\r\nContent-Length: 99999999\r\n\r\n").first.code,
              ErrorCode::io_failure);
}

TEST(StreamClient, SaysThatNobodyListensAndTriesAgainLessAndLessOften) {
    std::uint16_t free_port = 0;
    {
        SmallStreamServer gone{[](StreamPeer& peer, int) -> asio::awaitable<void> { co_await peer.stay(); }};
        free_port = gone.address().port;
    }
    Listening listening{{"127.0.0.1", free_port}};
    ASSERT_TRUE(listening.run_until([&] { return listening.lost.size() >= 4; }));
    EXPECT_THAT(listening.lost[0].detail, HasSubstr("is the server running there?"));
    EXPECT_LT(listening.waits[0], listening.waits[2]);
    EXPECT_LE(listening.waits[3], milliseconds{50});
}

TEST(StreamClient, AServerThatSaysNoHelloIsLeft) {
    SmallStreamServer server{[](StreamPeer& peer, int n) -> asio::awaitable<void> {
        if (n == 0) {
            proto::ServerMessage early;
            early.mutable_clock()->set_playing(true);
            co_await peer.say(early);
            co_await peer.stay();
        }
        if (n == 1) co_await peer.greet([](auto& hello) { hello.set_extent_log2_pages(31); });
        co_await peer.wait(milliseconds{3000});
    }};
    Listening listening{server.address()};
    ASSERT_TRUE(listening.run_until([&] { return listening.lost.size() >= 3; }));
    EXPECT_THAT(listening.lost[0].detail, HasSubstr("without a hello"));
    EXPECT_THAT(listening.lost[1].detail, HasSubstr("extent_log2_pages"));
    EXPECT_THAT(listening.lost[2].detail, AnyOf(HasSubstr("said no hello"), HasSubstr("nothing was heard")));
    EXPECT_TRUE(listening.hellos.empty());
}

TEST(StreamClient, GoesOnAfterABreakFromWhatItWasTold) {
    std::vector<proto::ClientHello> hellos;
    std::vector<proto::Windows> windows;
    SmallStreamServer server{[&](StreamPeer& peer, int n) -> asio::awaitable<void> {
        const std::function<void(proto::ServerHello&)> change = [&](proto::ServerHello& hello) {
            hello.set_revision(n == 0 ? 0 : 30);
            hello.set_resumed(n == 1);
            if (n == 2) hello.set_lineage("another");
        };
        const proto::ClientHello hello = co_await peer.greet(change);
        hellos.push_back(hello);
        const auto told = co_await peer.hear(proto::ClientMessage::kWindows);
        if (told) windows.push_back(told->windows());
        if (n == 0) co_return;
        if (n == 1) {
            proto::ServerMessage message;
            message.mutable_invalidation()->set_revision(25);
            co_await peer.say(message);
            co_await peer.wait(milliseconds{50});
            co_return;
        }
        co_await peer.stay();
    }};
    Listening listening{server.address()};
    proto::Window window;
    window.set_x1(4);
    window.set_y1(4);
    listening.client->watch({window}, 0);
    ASSERT_TRUE(listening.run_until([&] { return listening.hellos.size() >= 3; }));
    listening.run_for(milliseconds{50});
    ASSERT_EQ(windows.size(), 3u);
    EXPECT_EQ(hellos[0].lineage(), "");
    EXPECT_EQ(hellos[1].lineage(), "one");
    EXPECT_EQ(hellos[1].fingerprint(), "abc");
    EXPECT_EQ(hellos[1].seen_revision(), 0u);
    EXPECT_TRUE(windows[1].has_seen_revision()) << "0 is a revision, too";
    EXPECT_TRUE(listening.hellos[1].resumed());
    EXPECT_EQ(hellos[2].seen_revision(), 25u);
    EXPECT_FALSE(listening.hellos[2].resumed());
    EXPECT_EQ(windows[2].seen_revision(), 30u) << "of another history, nothing older is there";
    EXPECT_EQ(listening.client->newest_revision(), 30u);
}

TEST(StreamClient, WindowsBeyondTheServersLimitsAreLeftOut) {
    std::vector<proto::Windows> windows;
    SmallStreamServer server{[&](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet([](auto& hello) { hello.mutable_limits()->set_window_pages(100); });
        const auto told = co_await peer.hear(proto::ClientMessage::kWindows);
        if (told) windows.push_back(told->windows());
        co_await peer.stay();
    }};
    Listening listening{server.address()};
    proto::Window small, wide;
    small.set_x1(8);
    small.set_y1(8);
    wide.set_x1(64);
    wide.set_y1(64);
    listening.client->watch({small, wide}, 7);
    ASSERT_TRUE(listening.run_until([&] { return !windows.empty(); }));
    EXPECT_EQ(windows[0].windows_size(), 1);
}

TEST(StreamClient, PresenceClocksAndEditsOfOthersAreHeard) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        const proto::ClientHello hello = co_await peer.greet();
        const auto there = co_await peer.hear(proto::ClientMessage::kPresence);
        proto::ServerMessage message;
        proto::Present::Person& person = *message.mutable_present()->add_people();
        person.set_name(hello.name());
        *person.mutable_presence() = there->presence();
        co_await peer.say(message);
        message.mutable_clock()->set_step(5);
        co_await peer.say(message);
        message.mutable_edit_done()->set_author("Ada");
        co_await peer.say(message);
        co_await peer.stay();
    }};
    StreamSettings settings = Listening::quick();
    settings.name = "Grace";
    Listening listening{server.address(), settings};
    proto::Presence presence;
    presence.set_x(12.5);
    listening.client->be_present(presence);
    ASSERT_TRUE(listening.run_until([&] { return !listening.edits.empty(); }));
    EXPECT_EQ(listening.people.at(0).people(0).name(), "Grace");
    EXPECT_EQ(listening.people.at(0).people(0).presence().x(), 12.5);
    EXPECT_EQ(listening.clocks.at(0).step(), 5);
    EXPECT_EQ(listening.edits[0].author(), "Ada");
}

TEST(StreamClient, AProgramThatStoodStillDoesNotTakeItForTheServersSilence) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        co_await peer.stay();
    }};
    StreamSettings settings = Listening::quick();
    settings.ping_every = milliseconds{20000};  // nothing waits to be heard
    settings.limits.silence_timeout = milliseconds{2000};
    Listening listening{server.address(), settings};
    ASSERT_TRUE(listening.run_until([&] { return listening.client->statistics().round_trip.count() > 0; }));
    std::this_thread::sleep_for(milliseconds{2500});
    listening.run_for(milliseconds{300});
    EXPECT_TRUE(listening.lost.empty()) << listening.lost.front().detail;
    EXPECT_TRUE(listening.run_until([&] { return !listening.lost.empty(); })) << "while it runs, it counts";
}

TEST(StreamClient, MeasuresTheRoundTrip) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        co_await peer.stay();
    }};
    Listening listening{server.address()};
    ASSERT_TRUE(listening.run_until([&] { return listening.client->statistics().round_trip.count() > 0; }));
    EXPECT_LT(listening.client->statistics().round_trip, std::chrono::seconds{1});
}

TEST(StreamClient, ForgetsEverybodyWhenItIsDestroyed) {
    SmallStreamServer server{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        co_await peer.stay();
    }};
    Listening listening{server.address()};
    bool ended = false;
    listening.when_open = [&] {
        listening.client->ask({.id = 1, .page = {0, 0, 0}, .have = {}});
        listening.client->edit({}, [&](const EditFate&) { ended = true; });
        listening.client.reset();  // even from within a callback
    };
    ASSERT_TRUE(listening.run_until([&] { return !listening.hellos.empty(); }));
    listening.context.run();  // ends, since nothing is left to do
    EXPECT_TRUE(listening.pages.empty());
    EXPECT_TRUE(listening.lost.empty());
    EXPECT_FALSE(ended);
}

}  // namespace
}  // namespace tessera
