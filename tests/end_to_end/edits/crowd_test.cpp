// Many editors at a time, over real sockets, and what happens to a server meanwhile.
#include <atomic>
#include <barrier>
#include <map>
#include <mutex>
#include <thread>

#include <signal.h>

#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

constexpr int people = 8;

/// `work` for everybody at once, each with a number.
template <class Work>
void at_once(Work work) {
    std::vector<std::jthread> threads;
    for (int i = 0; i < people; ++i) threads.emplace_back([&, i] { work(i); });
}

class Crowd : public EditedScenes {};

TEST_F(Crowd, AnEditThatManySendAtOnceIsInOnce) {
    Program program = serve({});
    const std::uint16_t port = program.port();
    constexpr int rounds = 40;
    std::vector<proto::Edit> edits;
    for (int i = 0; i < rounds; ++i)
        edits.push_back(placing(static_cast<std::uint64_t>(i) + 1, 20.0 * i, 50));
    std::mutex mutex;
    std::map<int, std::vector<proto::EditAnswer>> answers;
    std::barrier ready{people};
    at_once([&](int) {
        RawClient client{port};
        for (int i = 0; i < rounds; ++i) {
            ready.arrive_and_wait();
            const auto reply = send(client, edits[static_cast<std::size_t>(i)]);
            const std::lock_guard lock{mutex};
            ASSERT_TRUE(reply);
            answers[i].push_back(answer_in(*reply));
        }
    });
    for (const auto& [i, of_one] : answers) {
        ASSERT_EQ(of_one.size(), static_cast<std::size_t>(people));
        int first = 0;
        for (const proto::EditAnswer& answer : of_one) {
            EXPECT_EQ(answer.revision(), static_cast<std::uint64_t>(i) + 1);
            first += !answer.again();
        }
        EXPECT_EQ(first, 1) << "edit " << i;
    }
}

TEST_F(Crowd, OfEditsOnOneBaseOneIsIn) {
    Program program = serve();
    const std::uint16_t port = program.port();
    constexpr int rounds = 40;
    std::atomic<int> accepted = 0, conflicts = 0;
    std::barrier ready{people};
    at_once([&](int person) {
        RawClient client{port};
        for (int i = 0; i < rounds; ++i) {
            proto::Edit edit =
                placing(static_cast<std::uint64_t>(i * people + person) + 1, 20.0 * i, 50.0 * person);
            edit.set_base_revision(static_cast<std::uint64_t>(i));
            ready.arrive_and_wait();
            const auto reply = send(client, edit);
            ASSERT_TRUE(reply);
            if (reply->status == 200) {
                ++accepted;
                EXPECT_EQ(answer_in(*reply).revision(), static_cast<std::uint64_t>(i) + 1);
            } else {
                ++conflicts;
                EXPECT_EQ(reply->status, 409) << reply->body;
            }
            ready.arrive_and_wait();
        }
    });
    EXPECT_EQ(accepted, rounds);
    EXPECT_EQ(conflicts, rounds * (people - 1));
}

TEST_F(Crowd, ReloadsInTheMiddleLoseNothing) {
    Program program = serve({});
    const std::uint16_t port = program.port();
    constexpr int each = 60;
    std::atomic<std::uint64_t> highest = 0;
    std::mutex mutex;
    std::map<std::uint64_t, int> by_revision;
    std::atomic<bool> over = false;
    std::jthread reloader{[&] {
        while (!over) {
            program.signal(SIGHUP);
            std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
    }};
    at_once([&](int person) {
        RawClient client{port};
        const auto id = static_cast<std::uint64_t>(person) + 1;
        for (int i = 0; i < each; ++i) {
            proto::Edit edit = placing(id, 30.0 * person, 0);
            if (i > 0) {
                proto::SpriteMove& move = *edit.mutable_changes(0)->mutable_move_sprite();
                move.set_id(id);
                move.set_y(i);
            }
            const auto reply = send(client, edit);
            ASSERT_TRUE(reply) << program.errors();
            const proto::EditAnswer answer = answer_in(*reply);
            const std::lock_guard lock{mutex};
            ++by_revision[answer.revision()];
            highest = std::max(highest.load(), answer.revision());
        }
    });
    over = true;
    EXPECT_EQ(highest, static_cast<std::uint64_t>(people * each));
    EXPECT_EQ(by_revision.size(), static_cast<std::size_t>(people * each));
    RawClient client{port};
    const std::string page = "/scenes/sprites/6/0/0.png", lived = client.get(page)->body;
    client.close();
    reloader.join();
    program.signal(SIGTERM);
    EXPECT_EQ(program.exit_code(), 0);
    Program again = serve({});
    RawClient reader{again.port()};
    EXPECT_EQ(reader.get(page)->body, lived);
}

TEST_F(Crowd, ASceneWhoseFileTakesNoEditsAnyMoreRefusesThemUntilItDoesAgain) {
    Program program = serve({});
    RawClient client{program.port()};
    answer_in(*send(client, placing(1, 100, 100)));
    const std::string page = "/scenes/sprites/6/0/0.png", edited = client.get(page)->body;
    const std::filesystem::path file = folder.path / "sprites" / "scene.json";
    std::filesystem::rename(file, folder.path / "before.json");
    const auto reload = [&] {
        program.forget();
        program.signal(SIGHUP);
        EXPECT_TRUE(program.says("reloaded: ")) << program.errors();
    };
    write("sprites/scene.json", std::string{R"({"checker": {"cell_texels": 8}, "extent_log2_pages": 6})"});
    reload();
    EXPECT_NE(client.get(page)->body, edited);
    const auto refused = send(client, moving(1, 200, 100));
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->status, 400) << "nobody would see it";
    EXPECT_NE(refused->body.find("takes no edits"), std::string::npos) << refused->body;
    std::filesystem::rename(folder.path / "before.json", file);
    reload();
    EXPECT_TRUE(client.get(page)->body == edited);
    EXPECT_EQ(answer_in(*send(client, moving(1, 200, 100))).revision(), 2u);
}

TEST_F(Crowd, WithoutARoomForItsJournalASceneIsServedAndRefusesEdits) {
    write("edits", std::string{"a file where the folder should be"});
    Program program = serve({"--edits", (folder.path / "edits").string()});
    RawClient client{program.port()};
    EXPECT_EQ(client.get("/scenes/sprites/6/0/0.png")->status, 200);
    const auto refused = send(client, placing(1, 1, 1));
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->status, 503);
    EXPECT_NE(refused->body.find("journal"), std::string::npos);
    EXPECT_EQ(refused->body.find(folder.path.string()), std::string::npos) << "says where its files are";
    EXPECT_TRUE(program.says((folder.path / "edits").string()));
}

TEST_F(Crowd, IsCountedInTheMetrics) {
    Program program = serve({});
    RawClient client{program.port()};
    answer_in(*send(client, placing(1, 1, 1)));
    const proto::Edit second = placing(2, 1, 1);
    answer_in(*send(client, second));
    answer_in(*send(client, second));
    EXPECT_EQ(send(client, placing(2, 9, 9))->status, 400);
    proto::Edit late = placing(3, 1, 1);
    late.set_base_revision(1);
    EXPECT_EQ(send(client, late)->status, 409);
    const std::string metrics = client.get("/metrics")->body;
    for (const char* line :
         {"tessera_edits_accepted_total 2", "tessera_edits_again_total 1",
          "tessera_edits_refused_total{reason=\"wrong\"} 1",
          "tessera_edits_refused_total{reason=\"conflict\"} 1", "tessera_edit_seconds_count 3",
          "tessera_scene_revision{scene=\"sprites\"} 2", "tessera_scene_sprites{scene=\"sprites\"} 2",
          "tessera_journal_edits{scene=\"sprites\"} 2",
          "tessera_journal_edits_since_snapshot{scene=\"sprites\"} 2",
          "tessera_journal_trouble{scene=\"sprites\"} 0"})
        EXPECT_NE(metrics.find(line), std::string::npos) << line;
    EXPECT_NE(metrics.find("tessera_journal_bytes{scene=\"sprites\"} "), std::string::npos);
    EXPECT_NE(metrics.find("tessera_http_answers_total{status=\"409\"} 1"), std::string::npos);
}

}  // namespace
}  // namespace tessera
