// Many edit, read and reload at once: what a page's tag names is one thing, before a restart and after it.
#include <atomic>
#include <cstdio>
#include <map>
#include <mutex>
#include <thread>

#include <signal.h>

#include "tests/end_to_end/document_edits/mixed_edits.h"

namespace tessera {
namespace {

using namespace test;

constexpr int writers = 4, readers = 4, edits_each = 150;

TEST(MixedReaders, SeeOneThingUnderATagWhoeverEditsAndReloads) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    const MixedScene scene;
    const tests::TemporaryFolder folder;
    std::map<std::string, std::string> bytes_of;  // By address and tag
    std::mutex mutex;
    std::atomic<int> writing = writers;
    std::atomic<int> looks = 0, again = 0, accepted = 0, reloads = 0;
    const auto look_at = [&](RawClient& client, const std::string& address) {
        const auto reply = client.get(address);
        ASSERT_TRUE(reply);
        ASSERT_EQ(reply->status, 200) << reply->body;
        const std::string name = address + (*reply)["etag"];
        const std::lock_guard lock{mutex};
        const auto [known, is_new] = bytes_of.emplace(name, reply->body);
        ASSERT_TRUE(known->second == reply->body) << name << " names two pages";
        again += is_new ? 0 : 1;
        ++looks;
    };
    // The finest, which are quick; and nothing is kept: each look is an evaluation
    std::vector<SeenPage> pages = pages_to_see();
    std::erase_if(pages, [](const SeenPage& page) { return page.z != 6 || *page.parameter != '\0'; });
    const std::vector<std::string> without_cache{"--cache-mb", "0"};
    std::map<std::string, std::string> last;
    {
        Program program = scene.serve(folder, without_cache);
        const std::uint16_t port = program.port();
        {
            std::vector<std::jthread> people;
            for (std::uint64_t writer = 0; writer < writers; ++writer)
                people.emplace_back([&, writer] {
                    MixedEdits random{seed + writer};
                    RawClient client{port};
                    for (int i = 0; i < edits_each && !testing::Test::HasFailure(); ++i) {
                        const auto reply = MixedScene::send(client, random.next());
                        if (!reply || (reply->status != 200 && reply->status != 400)) {
                            ADD_FAILURE() << (reply ? reply->body : "no answer");
                            break;
                        }
                        accepted += reply->status == 200;
                    }
                    --writing;
                });
            for (std::uint64_t reader = 0; reader < readers; ++reader)
                people.emplace_back([&, reader] {
                    MixedEdits random{seed + writers + reader};
                    RawClient client{port};
                    while (writing > 0 && !testing::Test::HasFailure())
                        look_at(client, pages[random.below(pages.size())].address());
                });
            people.emplace_back([&] {
                for (; writing > 0; ++reloads) {
                    program.signal(SIGHUP);
                    std::this_thread::sleep_for(std::chrono::milliseconds{15});
                }
            });
        }
        RawClient client{port};
        for (const SeenPage& page : pages) {
            const auto reply = client.get(page.address());
            ASSERT_TRUE(reply);
            last[page.address()] = (*reply)["etag"];
            look_at(client, page.address());
        }
        program.signal(SIGKILL);
    }
    std::printf("[          ] %d looks at pages, %d under a known tag, %d edits, %d reloads\n", looks.load(),
                again.load(), accepted.load(), reloads.load());
    EXPECT_GT(accepted, writers * edits_each / 4);
    EXPECT_GT(again, 20);
    EXPECT_GT(reloads, 3);
    Program program = scene.serve(folder, without_cache);
    RawClient client{program.port()};
    for (const SeenPage& page : pages) {
        EXPECT_EQ((*client.get(page.address()))["etag"], last[page.address()]);
        look_at(client, page.address());
    }
}

}  // namespace
}  // namespace tessera
