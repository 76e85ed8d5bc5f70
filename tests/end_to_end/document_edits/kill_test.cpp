// kill -9 fifty times in a stream of edits of every kind: each that was acknowledged is there, once and in
// order, and pages are those of a server that was never killed.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <stop_token>
#include <thread>

#include <signal.h>

#include "tests/end_to_end/document_edits/mixed_edits.h"

namespace tessera {
namespace {

using namespace test;

constexpr int kills = 50;

TEST(KilledServer, HasWhatItAcknowledgedOfEveryKindAndThePagesOfOneThatWasNot) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    MixedEdits random{seed};
    const MixedScene scene;
    const tests::TemporaryFolder folder;

    std::vector<proto::Edit> accepted;  // By revision, from 1 on
    std::optional<proto::Edit> unanswered;
    int in_without_answer = 0;
    for (int kill = 0; kill <= kills; ++kill) {
        Program program = scene.serve(folder);
        RawClient client{program.port()};
        if (unanswered) {
            // The same id: it is in once, whether it was in already or not
            const auto reply = MixedScene::send(client, *unanswered);
            ASSERT_TRUE(reply) << "after kill " << kill;
            if (reply->status == 200) {
                const proto::EditAnswer answer = answer_in(*reply);
                ASSERT_EQ(answer.revision(), accepted.size() + 1) << "after kill " << kill;
                in_without_answer += answer.again();
                accepted.push_back(*unanswered);
            }
            unanswered.reset();
        }
        if (kill == kills) break;
        // Most lives take an edit, on however slow a machine
        std::atomic<bool> taken = kill % 5 == 4;
        const std::chrono::microseconds after{random.below(60'000)};
        std::jthread killer{[&](const std::stop_token& over) {
            while (!taken && !over.stop_requested())
                std::this_thread::sleep_for(std::chrono::milliseconds{1});
            std::this_thread::sleep_for(after);
            program.signal(SIGKILL);
        }};
        for (;;) {
            const proto::Edit edit = random.next();
            const auto reply = MixedScene::send(client, edit);
            if (!reply) {
                unanswered = edit;
                break;
            }
            if (reply->status != 200) continue;
            ASSERT_EQ(answer_in(*reply).revision(), accepted.size() + 1) << "after kill " << kill;
            accepted.push_back(edit);
            taken = true;
        }
    }
    ASSERT_GE(accepted.size(), std::size_t{kills} * 4 / 5);

    // The one that is never killed takes the same edits
    const tests::TemporaryFolder other_folder;
    Program killed = scene.serve(folder), whole = scene.serve(other_folder);
    RawClient of_killed{killed.port()}, of_whole{whole.port()};
    for (std::size_t i = 0; i < accepted.size(); ++i) {
        const auto reply = MixedScene::send(of_whole, accepted[i]);
        ASSERT_TRUE(reply);
        ASSERT_EQ(reply->status, 200) << reply->body;
        ASSERT_EQ(answer_in(*reply).revision(), i + 1);
    }
    for (const SeenPage& page : pages_to_see()) {
        const auto one = of_killed.get(page.address()), other = of_whole.get(page.address());
        ASSERT_TRUE(one && other);
        ASSERT_EQ(one->status, 200) << one->body;
        EXPECT_EQ((*one)["tessera-revision"], (*other)["tessera-revision"]) << page.address();
        EXPECT_TRUE(one->body == other->body) << page.address();
    }
    std::printf("[          ] %d kills: %zu edits accepted, %d in without an answer\n", kills,
                accepted.size(), in_without_answer);
}

}  // namespace
}  // namespace tessera
