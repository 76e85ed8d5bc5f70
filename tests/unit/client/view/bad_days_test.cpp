// A server's bad day, as the client's picture sees it: the best picture stays, what is wrong is said, and
// once the server is back only what changed is asked for again.
#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <gmock/gmock.h>

#include "client/link/scene_info.h"
#include "client/view/frame_painter.h"
#include "client/view/record/session_recorder.h"
#include "client/view/stream_page_source.h"
#include "tests/unit/client/link/small_stream_server.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using test::SmallStreamServer;
using test::StreamPeer;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Extent extent{6};
constexpr std::uint32_t colour_before = 0xff406080, colour_after = 0xff20c0a0;

proto::ServerMessage page_of(const proto::PageAsk& ask, std::uint32_t colour, std::uint64_t revision,
                             std::uint64_t scene_revision) {
    proto::ServerMessage message = test::small_page(ask, 'p', revision);
    proto::PageData& page = *message.mutable_page();
    page.clear_texels();
    page.set_colour(colour);
    page.set_scene_revision(scene_revision);
    page.set_tag("at " + std::to_string(revision));
    return message;
}

PageKey key_of(const proto::PageAsk& ask) {
    return {static_cast<std::uint8_t>(ask.page().level()), static_cast<std::uint32_t>(ask.page().x()),
            static_cast<std::uint32_t>(ask.page().y())};
}

/// What the server did, so that the test sees it.
struct Seen {
    std::mutex mutex;
    std::vector<PageKey> asked[4];  ///< By connection
    std::atomic<bool> edit_now{false};
    std::atomic<int> mistakes{0};
    void ask(int n, PageKey page) {
        const std::lock_guard lock{mutex};
        asked[std::min(n, 3)].push_back(page);
    }
    std::vector<PageKey> of(int n) {
        const std::lock_guard lock{mutex};
        return asked[n];
    }
};

constexpr PageKey edited{0, 32, 32};

proto::ServerMessage news_of_edit() {
    proto::ServerMessage message;
    message.mutable_invalidation()->set_revision(8);
    proto::StalePages& stale = *message.mutable_invalidation()->add_stale();
    stale.set_level(edited.level);
    stale.add_x(edited.x);
    stale.add_y(edited.y);
    stale.add_revision(8);
    return message;
}

/// Right pages, until the edit; then one mistake after the other for the edited page.
asio::awaitable<void> first_connection(StreamPeer& peer, std::shared_ptr<Seen> seen) {
    asio::co_spawn(
        peer.stream.get_executor(),
        [&peer, seen]() -> asio::awaitable<void> {
            while (!seen->edit_now) co_await peer.wait(5ms);
            proto::ServerMessage news = news_of_edit();
            co_await peer.say(news);
        },
        asio::detached);
    for (;;) {
        const auto heard = co_await peer.hear(proto::ClientMessage::kAsk);
        if (!heard) co_return;
        for (const proto::PageAsk& ask : heard->ask().asks()) {
            seen->ask(0, key_of(ask));
            proto::ServerMessage right = page_of(ask, colour_before, 0, 7);
            if (!seen->edit_now) {
                co_await peer.say(right);
                continue;
            }
            switch (seen->mistakes++) {
                case 0: {  // of the wrong size
                    proto::ServerMessage wrong = test::small_page(ask, 'w', 8);
                    wrong.mutable_page()->set_scene_revision(8);
                    co_await peer.say(wrong);
                    break;
                }
                case 1:  // of a version from before the edit, and one that nobody asked for
                    co_await peer.say(right);
                    right.mutable_page()->set_id(ask.id() + 1000);
                    co_await peer.say(right);
                    break;
                case 2: {  // truncated, twice
                    proto::ServerMessage wrong = test::small_page(ask, 'w', 8);
                    wrong.mutable_page()->mutable_texels()->resize(20);
                    wrong.mutable_page()->set_scene_revision(8);
                    co_await peer.say(wrong);
                    co_await peer.say(wrong);
                    break;
                }
                default: {  // stalls, and goes away in the middle of a message
                    co_await peer.wait(2000ms);
                    co_await peer.say_raw(std::string{"\x82\x7e\x01\x00half of it", 14});
                    boost::system::error_code ignored;
                    peer.stream.next_layer().close(ignored);
                    co_return;
                }
            }
        }
    }
}

/// Back, with the edit.
asio::awaitable<void> later_connection(StreamPeer& peer, std::shared_ptr<Seen> seen, int n) {
    for (;;) {
        const auto heard = co_await peer.hear(proto::ClientMessage::kAsk);
        if (!heard) co_return;
        for (const proto::PageAsk& ask : heard->ask().asks()) {
            seen->ask(n, key_of(ask));
            const bool is_edited = key_of(ask) == edited;
            proto::ServerMessage right =
                page_of(ask, is_edited ? colour_after : colour_before, is_edited ? 8 : 0, 8);
            co_await peer.say(right);
        }
    }
}

TEST(BadDays, TheBestPictureStaysWhateverTheServerDoesAndOnlyWhatChangedIsAskedForAgain) {
    const auto seen = std::make_shared<Seen>();
    const SmallStreamServer server{[seen](StreamPeer& peer, int n) -> asio::awaitable<void> {
                                       const std::function<void(proto::ServerHello&)> change =
                                           [n](proto::ServerHello& hello) {
                                               hello.set_revision(n == 0 ? 7 : 8);
                                               hello.set_resumed(n > 0);
                                           };
                                       co_await peer.greet(change);
                                       if (n == 0)
                                           co_await first_connection(peer, seen);
                                       else
                                           co_await later_connection(peer, seen, n);
                                   },
                                   [](int n) {
                                       return n == 1 || n == 2 ? std::string{"HTTP/1.1 503 Busy\r\nContent-Length: 12\r\n\r\ntoo many now"}
                                    : std::string{};
                                   }};
    SceneInfo info;
    info.id = "checker";
    info.extent = extent;

    const auto context = testing::headless_context();
    StreamPageSource source{server.address(), info, ChannelSet::albedo, "somebody"};
    ResidencySettings settings{.slots = 128};
    settings.requests.first_back_off = ClientTime{20};
    settings.requests.longest_back_off = ClientTime{100};
    const auto scene = PlaneScene::make(extent, source, settings);
    ASSERT_TRUE(scene) << scene.error().detail;
    FramePainter painter{**scene};
    const FrameTarget target{96, 80};
    ViewFrame frame{.camera = {.ground = {32 * 256 + 128, 32 * 256 + 128, 0, 0},
                               .height_texels = 90,
                               .pitch_degrees = -85},
                    .width = 96,
                    .height = 80};
    frame.haze = false;
    const auto begin = std::chrono::steady_clock::now();
    ResidencyFrame outcome;
    const auto picture = [&] {
        frame.time = {std::chrono::duration_cast<ClientTime>(std::chrono::steady_clock::now() - begin) +
                      ClientTime{1}};
        outcome = painter.update(frame);
        EXPECT_TRUE(painter.draw(frame, target));
        std::this_thread::sleep_for(4ms);
        return hash_of_picture(target.read());
    };
    const auto until = [&](const std::function<bool()>& is_there, std::chrono::seconds most = 20s) {
        const auto end = std::chrono::steady_clock::now() + most;
        while (!is_there() && std::chrono::steady_clock::now() < end) picture();
        return is_there();
    };
    ASSERT_TRUE(until([&] { return outcome.needed > 0 && outcome.is_current() && seen->of(0).size() > 20; }));
    ASSERT_TRUE(until([&] { return painter.scene().residency().requests().in_flight() == 0; }));
    const std::uint64_t best = picture();
    const std::size_t asked_before = seen->of(0).size();
    EXPECT_EQ(source.state().trouble, "");

    // The bad day: no frame shows anything but the best picture there is
    seen->edit_now = true;
    std::set<std::string> troubles;
    bool was_stale = false;
    const auto frames_until = std::chrono::steady_clock::now() + 40s;
    std::uint64_t now_shown = best;
    while (now_shown == best && std::chrono::steady_clock::now() < frames_until) {
        now_shown = picture();
        was_stale = was_stale || outcome.stale > 0;
        EXPECT_TRUE(outcome.is_sharp()) << "an old page is better than a coarse one";
        if (const std::string trouble = source.state().trouble; !trouble.empty()) troubles.insert(trouble);
    }
    EXPECT_GE(seen->mistakes, 4) << "all of the day came about";
    EXPECT_TRUE(was_stale);
    EXPECT_GE(server.connections(), 4);
    const std::string said = ::testing::PrintToString(troubles);
    EXPECT_THAT(said, AllOf(HasSubstr("too many now"), HasSubstr("trying again in"),
                            HasSubstr("closed the connection")));

    // Back: the edit shows, nothing is wrong, and nothing but the edited page was asked for again
    ASSERT_TRUE(until([&] { return outcome.is_current() && source.state().trouble.empty(); }));
    EXPECT_NE(picture(), best);
    const auto after = seen->of(3);
    EXPECT_EQ(after, std::vector{edited});
    const auto all = seen->of(0);
    EXPECT_TRUE(std::all_of(all.begin() + static_cast<std::ptrdiff_t>(asked_before), all.end(),
                            [](PageKey page) { return page == edited; }));
}

}  // namespace
}  // namespace tessera
