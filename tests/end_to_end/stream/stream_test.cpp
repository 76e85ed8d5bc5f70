// The stream over real sockets: what a client that follows the rules sees.
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "server/access/token.h"
#include "server/scene/png_file.h"
#include "tests/end_to_end/stream/live_server.h"
#include "tests/support/temporary_folder.h"

namespace tessera::test {
namespace {

using Case = proto::ServerMessage::MessageCase;
using namespace std::chrono_literals;

std::set<std::pair<std::int64_t, std::int64_t>> stale_in(const proto::Invalidation& message,
                                                         std::uint32_t level) {
    std::set<std::pair<std::int64_t, std::int64_t>> pages;
    for (const proto::StalePages& stale : message.stale())
        for (int i = 0; i < stale.x_size() && stale.level() == level; ++i)
            pages.emplace(stale.x(i), stale.y(i));
    return pages;
}

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

TEST(Stream, TellsExactlyThePagesWhoseTagsHaveChanged) {
    LiveServer live;
    RawClient http = live.http();
    StreamClient client = live.stream();
    ASSERT_TRUE(client.hello());
    client.watch(0, 0, 0, 6, 6);
    const auto tags = [&] {
        std::map<std::pair<std::int64_t, std::int64_t>, std::string> all;
        for (std::int64_t y = 0; y < 6; ++y)
            for (std::int64_t x = 0; x < 6; ++x)
                all[{x, y}] =
                    http.get("/scenes/made/10/" + std::to_string(x) + "/" + std::to_string(y) + ".png", {},
                             "HEAD")
                        ->fields["etag"];
        return all;
    };
    std::uint64_t revision = 0;
    for (int i = 0; i < 30; ++i) {
        const auto before = tags();
        const double x = static_cast<double>(hash(1, 1, i, 0) % 2048),
                     y = static_cast<double>(hash(1, 2, i, 0) % 2048);
        StreamClient editor = live.stream();
        ASSERT_TRUE(editor.hello());
        editor.send(message_of(i == 0 ? placing(1, x, y) : moving(1, x, y)));
        ASSERT_TRUE(editor.receive(Case::kEditDone));
        ++revision;
        std::set<std::pair<std::int64_t, std::int64_t>> told, changed;
        while (true) {
            const auto message = client.receive(Case::kInvalidation);
            ASSERT_TRUE(message);
            told.merge(stale_in(message->invalidation(), 0));
            if (message->invalidation().revision() == revision) break;
        }
        for (const auto& [page, tag] : tags())
            if (before.at(page) != tag) changed.insert(page);
        EXPECT_EQ(told, changed) << "edit " << i << " at " << x << ", " << y;
    }
}

TEST(Stream, GoesOnAfterABreak) {
    LiveServer live;
    StreamClient first = live.stream();
    auto hello = first.hello();
    ASSERT_TRUE(hello);
    first.send(message_of(placing(1, 100, 100)));
    ASSERT_TRUE(first.receive(Case::kEditDone));
    first.send(message_of(placing(2, 1000, 1000)));
    ASSERT_TRUE(first.receive(Case::kEditDone));

    proto::ClientHello again;
    again.set_lineage(hello->lineage());
    again.set_fingerprint(hello->fingerprint());
    again.set_seen_revision(1);
    StreamClient second = live.stream();
    const auto resumed = second.hello(again);
    ASSERT_TRUE(resumed);
    EXPECT_TRUE(resumed->resumed());
    second.watch(0, 0, 0, 8, 8);
    const auto told = second.receive(Case::kInvalidation);
    ASSERT_TRUE(told);
    EXPECT_EQ(told->invalidation().revision(), 2u);
    EXPECT_EQ(stale_in(told->invalidation(), 0), (std::set<std::pair<std::int64_t, std::int64_t>>{{3, 3}}));
    EXPECT_EQ(told->invalidation().stale(0).revision(0), 2u);

    // Revision 0 is one that can be seen, too
    second.watch(0, 0, 0, 1, 1, 0);
    const auto first_page = second.receive(Case::kInvalidation);
    ASSERT_TRUE(first_page);
    EXPECT_EQ(stale_in(first_page->invalidation(), 0),
              (std::set<std::pair<std::int64_t, std::int64_t>>{{0, 0}}));

    again.set_fingerprint("fedcba9876543210");
    StreamClient third = live.stream();
    const auto anew = third.hello(again);
    ASSERT_TRUE(anew);
    EXPECT_FALSE(anew->resumed());
    third.watch(0, 0, 0, 8, 8);
    const auto nothing = third.receive(Case::kInvalidation, 100ms);
    EXPECT_FALSE(nothing);
}

TEST(Stream, EditorsSeeEachOthersEditsAndEachOther) {
    LiveServer live;
    StreamClient ada = live.stream(), bob = live.stream();
    proto::ClientHello hello;
    hello.set_wants_edits(true);
    hello.set_wants_presence(true);
    hello.set_name("Ada");
    const auto ada_hello = ada.hello(hello);
    hello.set_name("Bob");
    const auto bob_hello = bob.hello(hello);
    ASSERT_TRUE(ada_hello && bob_hello);

    const auto seen = bob.receive(Case::kPresent);
    ASSERT_TRUE(seen);
    ASSERT_EQ(seen->present().people_size(), 1);
    EXPECT_EQ(seen->present().people(0).name(), "Ada");
    EXPECT_TRUE(seen->present().people(0).may_edit());

    proto::Edit edit = placing(1, 100, 100);
    edit.set_author("Ada");
    ada.send(message_of(edit));
    const auto own = ada.receive(Case::kEditDone);
    ASSERT_TRUE(own);
    EXPECT_EQ(own->edit_done().id(), edit.id());
    EXPECT_EQ(own->edit_done().answer().revision(), 1u);
    EXPECT_EQ(own->edit_done().answer().inverse().changes_size(), 1);
    const auto others = bob.receive(Case::kEditDone);
    ASSERT_TRUE(others);
    EXPECT_EQ(others->edit_done().id(), edit.id());
    EXPECT_EQ(others->edit_done().session(), ada_hello->session());
    EXPECT_EQ(others->edit_done().author(), "Ada");
    EXPECT_EQ(others->edit_done().answer().revision(), 1u);
    EXPECT_EQ(others->edit_done().answer().dirty_size(), 1);
    ASSERT_EQ(others->edit_done().changes_size(), 1);
    EXPECT_EQ(others->edit_done().changes(0).place_sprite().x(), 100);

    // A retry is answered with what is in, and told to nobody; an edit over HTTP is told to both
    ada.send(message_of(edit));
    const auto retried = ada.receive(Case::kEditDone);
    ASSERT_TRUE(retried);
    EXPECT_TRUE(retried->edit_done().answer().again());
    proto::ClientMessage presence;
    presence.mutable_presence()->set_x(1.5);
    presence.mutable_presence()->set_y(2.5);
    bob.send(presence);
    for (;;) {
        const auto there = ada.receive(Case::kPresent);
        ASSERT_TRUE(there);
        ASSERT_EQ(there->present().people_size(), 1);
        EXPECT_EQ(there->present().people(0).session(), bob_hello->session());
        if (!there->present().people(0).presence().has_x()) continue;
        EXPECT_EQ(there->present().people(0).presence().x(), 1.5);
        break;
    }
    proto::Edit refused = moving(99, 1, 1);
    ada.send(message_of(refused));
    const auto no = ada.receive(Case::kEditRefused);
    ASSERT_TRUE(no);
    EXPECT_EQ(no->edit_refused().id(), refused.id());
    EXPECT_EQ(no->edit_refused().why(), proto::EditRefused::wrong);

    const auto bobs_session = bob_hello->session();
    bob.socket().next_layer().close();
    const auto left = ada.receive(Case::kPresent);
    ASSERT_TRUE(left);
    ASSERT_EQ(left->present().left_size(), 1);
    EXPECT_EQ(left->present().left(0), bobs_session);
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

TEST(Stream, TellsThatTheSceneWasReplacedAndThatItIsGone) {
    LiveServer live;
    StreamClient client = live.stream();
    const auto hello = client.hello();
    ASSERT_TRUE(hello);
    live.publish("1111111111111111");
    const auto replaced = client.receive(Case::kReplaced);
    ASSERT_TRUE(replaced);
    EXPECT_NE(replaced->replaced().hello().fingerprint(), hello->fingerprint());
    EXPECT_EQ(replaced->replaced().hello().session(), hello->session());
    live.publish("1111111111111111", false);
    const auto goodbye = client.receive(Case::kGoodbye);
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->goodbye().why(), proto::Goodbye::scene_gone);
    EXPECT_FALSE(client.receive());
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

TEST(Stream, TellsEverybodyWhenTheClockIsSet) {
    // Only a scene of a folder takes edits of more than sprites
    const tests::TemporaryFolder folder;
    const auto scene = folder.path / "sprites";
    std::filesystem::create_directories(scene);
    const std::string png = [] {
        const auto bytes = to_png(16, 64, PngColor::rgba, 8, std::vector<std::uint8_t>(16 * 64 * 4, 200));
        return std::string{bytes.begin(), bytes.end()};
    }();
    std::ofstream{scene / "patterns.png", std::ios::binary} << png;
    std::ofstream{scene / "scene.json"} << R"({"checker": {"cell_texels": 8}, "extent_log2_pages": 6,
        "sprites": {"patterns": {"image": "patterns.png", "side_texels": 16}}})";
    LiveServer live;
    live.more.push_back(load_scene(scene).value());
    live.publish();
    StreamClient editor = live.stream("sprites"), viewer = live.stream("sprites");
    ASSERT_TRUE(editor.hello());
    ASSERT_TRUE(viewer.hello());
    proto::Edit edit = new_edit();
    proto::ClockChange& change = *edit.add_changes()->mutable_set_clock();
    change.set_playing(false);
    change.set_step(1234);
    editor.send(message_of(edit));
    proto::ClockNow told_editor;
    ASSERT_TRUE(editor.receive(Case::kEditDone, 10s, [&](const proto::ServerMessage& other) {
        EXPECT_FALSE(other.has_edit_refused()) << other.edit_refused().detail();
        if (other.has_clock()) told_editor = other.clock();
    }));
    const auto told = viewer.receive(Case::kClock);
    ASSERT_TRUE(told);
    for (const proto::ClockNow& clock : {told->clock(), told_editor}) {
        EXPECT_FALSE(clock.playing());
        EXPECT_EQ(clock.step(), 1234);
        EXPECT_EQ(clock.step_part(), 0);
    }
    // and whoever comes later
    StreamClient late = live.stream("sprites");
    const auto hello = late.hello();
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->clock().step(), 1234);
}

TEST(Stream, FromElsewhereWhoHoldsATokenMayEdit) {
    const tests::TemporaryFolder folder;
    const auto file = folder.path / "tokens";
    const std::string token = make_token();
    ASSERT_TRUE(add_token_line(file, token_line("editor", "ada", token, "")));
    LiveServer live;
    live.publish("0123456789abcdef", true, std::make_shared<const Access>(Access::load(file).value()));

    StreamClient stranger{live.server->port(), "made", "192.0.2.7"};
    const auto hello = stranger.hello();
    ASSERT_TRUE(hello);
    EXPECT_TRUE(hello->takes_edits());
    EXPECT_FALSE(hello->may_edit());
    EXPECT_FALSE(hello->why_not().empty());
    stranger.send(message_of(placing(1, 100, 100)));
    const auto refused = stranger.receive(Case::kEditRefused);
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->edit_refused().why(), proto::EditRefused::forbidden);
    stranger.grant(1);
    stranger.ask(1, 0, 0, 0);
    EXPECT_TRUE(stranger.receive(Case::kPage)) << "everybody may look";

    StreamClient ada{live.server->port(), "made", "192.0.2.7"};
    proto::ClientHello with_token;
    with_token.set_token(token);
    const auto allowed = ada.hello(with_token);
    ASSERT_TRUE(allowed);
    EXPECT_TRUE(allowed->may_edit()) << allowed->why_not();
    proto::ClientHello listens;
    listens.set_wants_edits(true);
    StreamClient listener = live.stream();
    ASSERT_TRUE(listener.hello(listens));
    ada.send(message_of(placing(1, 100, 100)));
    EXPECT_TRUE(ada.receive(Case::kEditDone));
    const auto told = listener.receive(Case::kEditDone);
    ASSERT_TRUE(told);
    EXPECT_EQ(told->edit_done().author(), "ada");
    // A token that is taken back edits no more, though the stream is open
    live.publish();
    ada.send(message_of(moving(1, 200, 200)));
    const auto no_more = ada.receive(Case::kEditRefused);
    ASSERT_TRUE(no_more);
    EXPECT_EQ(no_more->edit_refused().why(), proto::EditRefused::forbidden);
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
