// What clients do wrong on a stream, by mistake or on purpose: named, bounded, and without harm to others.
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "tests/end_to_end/stream/live_server.h"

namespace tessera::test {
namespace {

using Case = proto::ServerMessage::MessageCase;
using namespace std::chrono_literals;
namespace websocket = boost::beast::websocket;

std::string upgrade(const std::string& fields = {}, const std::string& scene = "made",
                    const std::string& version = "13") {
    return "GET /scenes/" + scene +
           "/stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: " +
           version + "\r\n" + fields + "\r\n";
}
const std::string protocol = "Sec-WebSocket-Protocol: tessera.stream.1\r\n";

/// A frame as a client sends it, masked by zeros.
std::string frame(char first, std::uint64_t length, const std::string& payload) {
    std::string bytes(1, first);
    if (length < 126) {
        bytes.push_back(static_cast<char>(0x80 | length));
    } else {
        bytes.push_back(static_cast<char>(0xff));
        for (int shift = 56; shift >= 0; shift -= 8)
            bytes.push_back(static_cast<char>(length >> shift & 0xff));
    }
    return bytes + std::string(4, '\0') + payload;
}
constexpr char binary = '\x82', ping = '\x89';

/// A client that sends what it likes once the connection is a WebSocket.
RawClient raw_stream(const LiveServer& live) {
    RawClient client = live.http();
    EXPECT_TRUE(client.send(upgrade(protocol)));
    const auto reply = client.receive();
    EXPECT_EQ(reply->status, 101);
    return client;
}

ServerOptions quick() {
    ServerOptions options = stream_options();
    options.streams.hello_time = 300ms;
    options.streams.ping_time = 300ms;
    options.streams.pong_time = 300ms;
    options.streams.close_time = 200ms;
    return options;
}

/// The server still serves a client that does nothing wrong.
void expect_alive(const LiveServer& live) {
    StreamClient client = live.stream();
    ASSERT_TRUE(client.open());
    ASSERT_TRUE(client.hello());
    client.grant(1);
    client.ask(1, 2, 0, 0);
    EXPECT_TRUE(client.receive(Case::kPage));
}

TEST(BadStream, IsRefusedBeforeItsUpgrade) {
    LiveServer live;
    const auto status = [&](const std::string& request) {
        RawClient client = live.http();
        EXPECT_TRUE(client.send(request));
        const auto reply = client.receive();
        return reply ? reply->status : 0;
    };
    EXPECT_EQ(status(upgrade(protocol + "Origin: http://evil.example\r\n")), 403);
    EXPECT_EQ(status(upgrade(protocol + "Origin: null\r\n")), 403);
    EXPECT_EQ(status(upgrade(protocol + "Origin: http://localhost\r\n")), 101);
    EXPECT_EQ(status(upgrade(protocol, "nobody")), 404);
    EXPECT_EQ(status(upgrade()), 400);
    EXPECT_EQ(status(upgrade("Sec-WebSocket-Protocol: tessera.stream.9\r\n")), 400);
    EXPECT_EQ(status(upgrade(protocol, "made", "8")), 426);
    EXPECT_EQ(status("GET /scenes/made/stream HTTP/1.1\r\nHost: localhost\r\n\r\n"), 426);
    EXPECT_EQ(status(upgrade(protocol + "Host: twice\r\n")), 400);
    EXPECT_EQ(status(upgrade(protocol + "Content-Length: 5\r\n")), 413);
    EXPECT_EQ(status("POST" + upgrade(protocol).substr(3)), 405);
    EXPECT_EQ(status(upgrade(protocol) + "early bytes"), 400);
    std::string wrong_key = upgrade(protocol);
    wrong_key.replace(wrong_key.find("dGhlIHN"), 4, "####");
    EXPECT_EQ(status(wrong_key), 400);
    expect_alive(live);
}

TEST(BadStream, OneTooManyIsTurnedAwayUntilAnotherEnds) {
    ServerOptions options = stream_options();
    options.streams.streams = 2;
    LiveServer live{options};
    auto first = std::make_unique<StreamClient>(live.server->port(), "made");
    StreamClient second = live.stream(), third = live.stream();
    EXPECT_TRUE(first->open() && second.open());
    EXPECT_FALSE(third.open());
    EXPECT_EQ(third.status(), 503u);
    first.reset();
    EXPECT_TRUE(eventually([&] { return live.server->stream_metrics().streams.Value() < 2; }));
    expect_alive(live);
}

TEST(BadStream, WithoutAHelloIsEnded) {
    LiveServer live{quick()};
    StreamClient client = live.stream();
    const auto goodbye = client.receive(Case::kGoodbye);
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->goodbye().why(), proto::Goodbye::idle);
    EXPECT_FALSE(client.receive());
    EXPECT_EQ(client.reason().code, websocket::close_code::policy_error);
}

TEST(BadStream, ThatSaysSomethingElseFirstIsEnded) {
    LiveServer live;
    StreamClient client = live.stream();
    client.grant(5);
    const auto goodbye = client.receive(Case::kGoodbye);
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->goodbye().why(), proto::Goodbye::wrong_message);
    EXPECT_FALSE(client.receive());
}

TEST(BadStream, OfGarbageIsEndedAndSoIsOneOfText) {
    LiveServer live;
    {
        StreamClient client = live.stream();
        ASSERT_TRUE(client.hello());
        client.send_bytes("\xff\xff\xff garbage");
        const auto goodbye = client.receive(Case::kGoodbye);
        ASSERT_TRUE(goodbye);
        EXPECT_EQ(goodbye->goodbye().why(), proto::Goodbye::wrong_message);
        EXPECT_FALSE(client.receive());
        EXPECT_EQ(client.reason().code, websocket::close_code::policy_error);
    }
    {
        StreamClient client = live.stream();
        ASSERT_TRUE(client.hello());
        client.socket().text(true);
        client.send_bytes("{\"hello\": {}}");
        EXPECT_FALSE(client.receive());
        EXPECT_EQ(client.reason().code, websocket::close_code::unknown_data);
    }
    {
        // Bytes that are no frames at all
        RawClient client = raw_stream(live);
        client.send(std::string(2000, '\xf7'));
        EXPECT_TRUE(client.is_closed());
    }
    expect_alive(live);
}

TEST(BadStream, OfAGiantFrameIsEndedBeforeTheFrameArrives) {
    LiveServer live;
    for (const std::uint64_t length :
         {std::uint64_t{1} << 30, std::uint64_t{1} << 62, std::uint64_t{300'000}}) {
        RawClient client = raw_stream(live);
        ASSERT_TRUE(client.send(frame(binary, length, {})));
        const auto begun = std::chrono::steady_clock::now();
        EXPECT_TRUE(client.is_closed());
        EXPECT_LT(std::chrono::steady_clock::now() - begun, 5s);
    }
    expect_alive(live);
}

TEST(BadStream, OfHalfAFrameOrOfNothingIsEndedWhenItAnswersNoPing) {
    LiveServer live{quick()};
    proto::ClientMessage hello;
    hello.mutable_hello();
    const std::string bytes = hello.SerializeAsString();
    const std::vector<std::string> halves{
        frame(binary, 1000, "half"), frame(binary, 1000, {}).substr(0, 3), {}};
    std::vector<RawClient> clients;
    for (const std::string& half : halves) {
        clients.push_back(raw_stream(live));
        ASSERT_TRUE(clients.back().send(frame(binary, bytes.size(), bytes)));
        if (!half.empty()) {
            ASSERT_TRUE(clients.back().send(half));
        }
    }
    for (RawClient& client : clients) EXPECT_TRUE(client.is_closed());
    EXPECT_TRUE(eventually([&] { return live.server->stream_metrics().streams.Value() == 0; }));
    expect_alive(live);
}

TEST(BadStream, ThatAnswersPingsIsLeftAlone) {
    LiveServer live{quick()};
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    // Reading answers pings; many of them pass
    EXPECT_FALSE(client.receive(Case::kPage, 2s));
    EXPECT_TRUE(client.open());
}

TEST(BadStream, ThatFloodsWithControlFramesIsEnded) {
    LiveServer live;
    RawClient client = raw_stream(live);
    std::string flood;
    for (int i = 0; i < 1000; ++i) flood += frame(ping, 4, "ping");
    client.send(flood);
    EXPECT_TRUE(client.is_closed());
    expect_alive(live);
}

TEST(BadStream, WithFieldsOfTomorrowIsUnderstood) {
    LiveServer live;
    StreamClient client = live.stream();
    proto::ClientMessage hello;
    hello.mutable_hello()->GetReflection()->MutableUnknownFields(hello.mutable_hello())->AddVarint(777, 5);
    client.send(hello);
    ASSERT_TRUE(client.receive(Case::kHello));
    // A message of a kind that is not known here is nothing
    proto::ClientMessage tomorrow;
    tomorrow.GetReflection()->MutableUnknownFields(&tomorrow)->AddLengthDelimited(99, "something");
    client.send(tomorrow);
    proto::ClientMessage ping_message;
    ping_message.mutable_ping()->set_payload(42);
    client.send(ping_message);
    const auto pong = client.receive(Case::kPong);
    ASSERT_TRUE(pong);
    EXPECT_EQ(pong->pong().payload(), 42u);
}

TEST(BadStream, WithTooMuchOfSomethingIsToldWhat) {
    LiveServer live;
    const auto ended = [&](const std::function<void(proto::ClientMessage&)>& make, const std::string& words) {
        StreamClient client = live.stream();
        ASSERT_TRUE(client.hello());
        proto::ClientMessage message;
        make(message);
        client.send(message);
        const auto goodbye = client.receive(Case::kGoodbye);
        ASSERT_TRUE(goodbye) << words;
        EXPECT_EQ(goodbye->goodbye().why(), proto::Goodbye::wrong_message);
        EXPECT_NE(goodbye->goodbye().detail().find(words), std::string::npos) << goodbye->goodbye().detail();
    };
    ended(
        [](auto& message) {
            for (int i = 0; i < 65; ++i) message.mutable_windows()->add_windows();
        },
        "windows");
    ended(
        [](auto& message) {
            auto& window = *message.mutable_windows()->add_windows();
            window.set_x1(1000);
            window.set_y1(1000);
        },
        "pages in all");
    ended(
        [](auto& message) {
            for (int i = 0; i < 1025; ++i) message.mutable_ask()->add_asks();
        },
        "asks");
    ended([](auto& message) { message.mutable_presence()->set_x(std::nan("")); }, "finite");
    ended(
        [](auto& message) {
            message.mutable_presence()->mutable_held()->mutable_path()->set_to_y(std::nan(""));
        },
        "finite");
    ended(
        [](auto& message) {
            for (int i = 0; i < 65; ++i) message.mutable_presence()->add_selected(1);
        },
        "64");
    ended([](auto& message) { message.mutable_hello(); }, "once");
    expect_alive(live);
}

TEST(BadStream, EditsThatAreWrongAreRefusedByNameAndItGoesOn) {
    LiveServer live;
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    const auto refused = [&](const proto::Edit& edit, proto::EditRefused::Why why, const std::string& words) {
        client.send(message_of(edit));
        const auto answer = client.receive(Case::kEditRefused);
        ASSERT_TRUE(answer) << words;
        EXPECT_EQ(answer->edit_refused().id(), edit.id());
        EXPECT_EQ(answer->edit_refused().why(), why) << answer->edit_refused().detail();
        EXPECT_NE(answer->edit_refused().detail().find(words), std::string::npos)
            << answer->edit_refused().detail();
    };
    using proto::EditRefused;
    const proto::Edit first = placing(1, 100, 100);
    client.send(message_of(first));
    ASSERT_TRUE(client.receive(Case::kEditDone));

    refused(placing(2, std::nan(""), 0), EditRefused::wrong, "changes[0].place_sprite.x");
    refused(placing(2, 0, 0x1p39), EditRefused::wrong,
            "changes[0].place_sprite.y: is outside of the texture");
    refused(moving(7, 1, 1), EditRefused::wrong, "no sprite 7");
    refused(new_edit(), EditRefused::wrong, "changes: is empty");
    proto::Edit edit = placing(2, 5, 5);
    edit.set_id("mine");
    refused(edit, EditRefused::wrong, "UUID");
    edit = placing(2, 5, 5);
    edit.GetReflection()->MutableUnknownFields(&edit)->AddVarint(777, 5);
    refused(edit, EditRefused::wrong, "does not know");
    edit = new_edit();
    for (std::uint64_t i = 0; i < 1025; ++i) edit.add_changes()->mutable_remove_sprite()->set_id(i + 1);
    refused(edit, EditRefused::wrong, "1024");
    edit = new_edit();
    edit.add_changes()->mutable_set_clock()->set_steps_per_second(std::nan(""));
    refused(edit, EditRefused::wrong, "changes[0].set_clock");
    edit = placing(2, 5, 5);
    edit.set_base_revision(9);
    refused(edit, EditRefused::conflict, "base_revision");
    edit = placing(2, 5, 5);
    edit.set_id(first.id());
    refused(edit, EditRefused::other_content, "");

    EXPECT_EQ(live.now()->revision, 1u);
    client.send(message_of(first));
    const auto again = client.receive(Case::kEditDone);
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->edit_done().answer().again());
    // A million changes are too much for a message: whoever sends them is ended before they are read
    edit = new_edit();
    for (std::uint64_t i = 0; i < 1'000'000; ++i) edit.add_changes()->mutable_remove_sprite()->set_id(i + 1);
    client.send(message_of(edit));
    EXPECT_TRUE(eventually([&] { return live.server->stream_metrics().streams.Value() == 0; }));
    EXPECT_EQ(live.now()->revision, 1u);
    expect_alive(live);
}

TEST(BadStream, WhoAsksWithoutReadingIsNotListenedTo) {
    LiveServer live;
    RawClient client = raw_stream(live);
    proto::ClientMessage message;
    message.mutable_hello();
    std::string bytes = message.SerializeAsString();
    ASSERT_TRUE(client.send(frame(binary, bytes.size(), bytes)));
    message.Clear();
    for (std::uint32_t id = 0; id < 1000; ++id) StreamClient::add_ask(message, id, 0, -1, 0);
    bytes = message.SerializeAsString();
    // Every ask is refused, and nobody reads the refusals: at some point the server reads no more
    std::atomic<int> sent = 0;
    std::jthread sender{[&] {
        while (sent < 20'000 && client.send(frame(binary, bytes.size(), bytes))) ++sent;
    }};
    int before = -1;
    while (before != sent) {
        before = sent;
        std::this_thread::sleep_for(300ms);
    }
    EXPECT_LT(sent, 20'000);
    expect_alive(live);
    client.shut_down();
}

std::size_t resident_bytes() {
    std::ifstream statm{"/proc/self/statm"};
    std::size_t pages = 0, resident = 0;
    statm >> pages >> resident;
    return resident * 4096;
}

TEST(BadStream, AReaderThatDoesNotReadNeverMakesTheServerGrow) {
    LiveServer live;
    StreamClient sleeper{live.server->port(), "made", {}, 4096};
    proto::ClientHello hello;
    hello.set_wants_edits(true);
    hello.set_wants_presence(true);
    ASSERT_TRUE(sleeper.hello(hello));
    sleeper.watch(0, 0, 0, 16, 16);
    StreamClient editor = live.stream();
    ASSERT_TRUE(editor.hello());
    editor.send(message_of(placing(1, 100, 100)));
    ASSERT_TRUE(editor.receive(Case::kEditDone));

    std::size_t after_some = 0;
    std::uint64_t revision = 1;
    constexpr int edits = 20'000, at_once = 100;
    for (int done = 0; done < edits; done += at_once) {
        for (int i = 0; i < at_once; ++i) {
            const auto n = static_cast<std::int64_t>(done + i);
            editor.send(message_of(moving(1, static_cast<double>(hash(1, 1, n, 0) % 4000),
                                          static_cast<double>(hash(1, 2, n, 0) % 4000))));
        }
        for (int i = 0; i < at_once; ++i) {
            const auto answer = editor.receive(Case::kEditDone);
            ASSERT_TRUE(answer);
            revision = std::max(revision, answer->edit_done().answer().revision());
        }
        if (done == edits / 4) after_some = resident_bytes();
    }
    EXPECT_EQ(revision, edits + 1u);
    // The scene remembers which page changed when, and the memory journal its edits; no reader's queue does
    EXPECT_LT(resident_bytes(), after_some + (std::size_t{24} << 20));
    // Now it reads: it learns that news were left out, and of everything that is stale
    std::uint64_t told = 0;
    int news = 0, invalidations = 0;
    bool missed = false;
    while (told < revision) {
        const auto message = sleeper.receive();
        ASSERT_TRUE(message);
        if (message->has_invalidation()) {
            told = message->invalidation().revision();
            ++invalidations;
        }
        if (message->has_edit_done()) {
            ++news;
            missed = missed || message->edit_done().id().empty();
        }
    }
    EXPECT_LT(invalidations, edits / 4);
    RecordProperty("invalidations", invalidations);
    RecordProperty("news", news);
    while (!missed) {
        const auto message = sleeper.receive(Case::kEditDone, 1s);
        if (!message) break;
        missed = message->edit_done().id().empty();
    }
    EXPECT_TRUE(missed);
}

TEST(BadStream, OneThatNeverReadsIsCut) {
    ServerOptions options = quick();
    options.streams.write_time = 400ms;
    LiveServer live{options};
    live.gated->open();
    StreamClient client{live.server->port(), "gated", {}, 4096};
    ASSERT_TRUE(client.hello());
    client.grant(1000);
    proto::ClientMessage message;
    for (std::uint32_t id = 0; id < 300; ++id) StreamClient::add_ask(message, id, 0, id, 0);
    message.mutable_ask()->mutable_options()->set_plain(true);
    client.send(message);
    EXPECT_TRUE(eventually([&] { return live.server->stream_metrics().streams.Value() == 0; }));
    expect_alive(live);
}

}  // namespace
}  // namespace tessera::test
