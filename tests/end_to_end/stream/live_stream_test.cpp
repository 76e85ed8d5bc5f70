// The stream over real sockets of a scene that changes: news of edits, of others, of the clock, and rights.
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

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

}  // namespace
}  // namespace tessera::test
