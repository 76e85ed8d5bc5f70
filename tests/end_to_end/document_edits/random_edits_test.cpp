// A thousand random edits of every kind over the network: what a page's tag promises, and what a restart must
// not change.
#include <cstdio>
#include <map>
#include <memory>

#include <signal.h>

#include "tests/end_to_end/document_edits/mixed_edits.h"

namespace tessera {
namespace {

using namespace test;

constexpr int edits = 1000;

TEST(MixedEditsTest, APagesTagTellsItsBytesAndARestartChangesNone) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    MixedEdits random{seed};
    const MixedScene scene;
    const tests::TemporaryFolder folder;
    std::vector<SeenPage> pages = pages_to_see();
    std::map<std::string, std::string> bytes_of;  // By address and tag
    std::map<int, int> kinds;
    std::uint64_t accepted = 0;
    int changed = 0, kept = 0, joined = 0, looks = 0, driven = 0;

    std::unique_ptr<Program> program{new Program(scene.serve(folder))};
    std::optional<RawClient> client{program->port()};
    const auto look_at = [&](SeenPage& page) {
        const auto reply = client->get(page.address());
        ASSERT_TRUE(reply);
        ASSERT_EQ(reply->status, 200) << reply->body;
        const std::string tag = (*reply)["etag"];
        ASSERT_FALSE(tag.empty());
        const auto [known, is_new] = bytes_of.emplace(page.address() + tag, reply->body);
        EXPECT_TRUE(known->second == reply->body)
            << page.address() << " has other bytes under its tag " << tag;
        // Where edits crowd their boxes are joined, and a page may be sent once more
        joined += std::stoull((*reply)["tessera-revision"]) > page.touched;
        ++looks;
        if (!page.tag.empty()) ++(page.tag == tag ? kept : changed);
        page.tag = tag;
        page.bytes = reply->body;
    };
    constexpr std::size_t views = parameters_to_see.size();
    const auto look_at_place = [&](std::size_t place) {
        for (std::size_t view = 0; view < views; ++view) look_at(pages[place + view]);
        // What shows the same frame is one page
        EXPECT_EQ(pages[place].tag, pages[place + 1].tag) << pages[place].address();
        driven += pages[place].bytes != pages[place + 2].bytes;
    };
    for (SeenPage& page : pages) look_at(page);

    for (int i = 0; i < edits && !HasFailure(); ++i) {
        const proto::Edit edit = random.next();
        const auto reply = MixedScene::send(*client, edit);
        ASSERT_TRUE(reply);
        if (reply->status == 200) {
            const proto::EditAnswer answer = answer_in(*reply);
            ASSERT_EQ(answer.revision(), ++accepted);
            for (const proto::Change& change : edit.changes()) ++kinds[change.change_case()];
            for (SeenPage& page : pages)
                for (const proto::DirtyBox& box : answer.dirty())
                    if (page.comes_near(box)) page.touched = answer.revision();
        } else {
            ASSERT_EQ(reply->status, 400) << reply->body;  // A sprite that is, or is not, there; a count of 0
        }
        const std::size_t seen = random.below(pages.size() / views) * views;
        for (std::size_t place = 0; place < pages.size(); place += views)
            if (place == seen || i % 250 == 249) look_at_place(place);
    }
    if (HasFailure()) return;
    std::printf(
        "[          ] %d looks at pages: %d with the same tag, %d with another, %d by an edit that did "
        "not come near\n",
        looks, kept, changed, joined);
    EXPECT_GT(accepted, edits / 3u);
    EXPECT_GT(changed, 50);
    EXPECT_GT(kept, 50);
    EXPECT_EQ(kinds.size(), 9u) << "of every kind";
    EXPECT_GT(driven, 20) << "pages show the frame that the request asks for";
    EXPECT_LT(joined * 5, looks) << "pages keep their tags where no edit comes";

    for (const int ending : {SIGTERM, SIGKILL}) {
        client.reset();
        program->signal(ending);
        program->exit_code();
        program.reset(new Program(scene.serve(folder)));
        client.emplace(program->port());
        for (SeenPage& page : pages) {
            const auto reply = client->get(page.address());
            ASSERT_TRUE(reply);
            EXPECT_EQ((*reply)["etag"], page.tag) << page.address();
            EXPECT_TRUE(reply->body == page.bytes) << page.address();
        }
    }
}

}  // namespace
}  // namespace tessera
