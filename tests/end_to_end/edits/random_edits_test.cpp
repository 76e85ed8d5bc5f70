// A thousand random edits: what a page's address promises, and what a restart must not change.
#include <cstdlib>
#include <map>
#include <memory>
#include <random>

#include <signal.h>

#include "shared/page/page_key.h"
#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

constexpr int edits = 1000, extent_log2_pages = 6;

std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

/// A page of the sample, and what was last seen of it.
struct Page {
    int z = 0, x = 0, y = 0;
    std::string tag{}, bytes{};
    std::uint64_t touched = 0;       ///< The last edit whose dirty boxes meet it …
    std::uint64_t near_touched = 0;  ///< … or come near: pages have one revision for every gutter.

    std::string address() const {
        return "/scenes/sprites/" + std::to_string(z) + "/" + std::to_string(x) + "/" + std::to_string(y) +
               ".png";
    }
    /// Whether `box` meets the page, or what `gutter` texels around it see.
    bool meets(const proto::DirtyBox& box, std::int64_t gutter) const {
        const int level = extent_log2_pages - z;
        const std::int64_t side = std::int64_t{256} << level, more = gutter << level;
        return box.x0() < (x + 1) * side + more && box.x1() > x * side - more &&
               box.y0() < (y + 1) * side + more && box.y1() > y * side - more;
    }
};

/// Every page of the coarse levels and, of the finer ones, those at a few places.
std::vector<Page> sample_of_pages() {
    std::vector<Page> pages;
    for (int z = 0; z <= extent_log2_pages; ++z) {
        const int side = 1 << z;
        for (const auto& [x, y] :
             {std::pair{0, 0}, {side / 2, side / 2}, {side - 1, 0}, {side / 4, side / 3}})
            if (std::none_of(pages.begin(), pages.end(), [&, x = x, y = y](const Page& other) {
                    return other.z == z && other.x == x && other.y == y;
                }))
                pages.push_back({z, x, y});
    }
    return pages;
}

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_{seed} {}
    std::uint64_t below(std::uint64_t count) {
        return std::uniform_int_distribution<std::uint64_t>{0, count - 1}(engine_);
    }
    /// Mostly where pages are looked at.
    double place() {
        const double side = 256 << extent_log2_pages;
        const double near[] = {200, side / 2, side - 100, side / 4, side / 3};
        return below(4) == 0 ? static_cast<double>(below(std::uint64_t(side) * 4)) / 4
                             : near[below(5)] + static_cast<double>(below(1600)) / 4 - 200;
    }
    proto::Edit edit() {
        proto::Edit edit = new_edit();
        for (std::uint64_t i = 0, n = 1 + below(3); i < n; ++i) {
            const std::uint64_t id = 1 + below(60);
            switch (below(5)) {
                case 0:
                case 1: {
                    proto::SpritePlacement& sprite = *edit.add_changes()->mutable_place_sprite();
                    sprite.set_id(id);
                    sprite.set_x(place());
                    sprite.set_y(place());
                    sprite.set_pattern(static_cast<std::uint32_t>(below(4)));
                    sprite.set_scale(0.5 + static_cast<double>(below(14)) / 4);
                    sprite.set_turn(static_cast<double>(below(16)) / 16);
                    break;
                }
                case 2:
                    edit.add_changes()->mutable_remove_sprite()->set_id(id);
                    break;
                default: {
                    proto::SpriteMove& move = *edit.add_changes()->mutable_move_sprite();
                    move.set_id(id);
                    move.set_x(place());
                    if (below(2) == 0) move.set_y(place());
                    if (below(3) == 0) move.set_turn(static_cast<double>(below(16)) / 16);
                    if (below(3) == 0) move.set_order(static_cast<std::int32_t>(below(5)));
                }
            }
        }
        return edit;
    }

  private:
    std::mt19937_64 engine_;
};

class RandomEdits : public EditedScenes {};

TEST_F(RandomEdits, APagesTagTellsItsBytesAndOnlyWhatIsTouchedGetsANewOne) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    Random random{seed};
    std::vector<Page> pages = sample_of_pages();
    std::map<std::string, std::string> bytes_of;  // By address and tag
    int accepted = 0, changed = 0, kept = 0;

    std::unique_ptr<Program> program{new Program(serve({}))};
    std::optional<RawClient> client{program->port()};
    const auto look_at = [&](Page& page) {
        const Reply reply = client->get(page.address()).value();
        ASSERT_EQ(reply.status, 200) << reply.body;
        const std::string tag = reply["etag"];
        ASSERT_FALSE(tag.empty());
        const auto [known, is_new] = bytes_of.emplace(page.address() + tag, reply.body);
        EXPECT_EQ(known->second, reply.body) << page.address() << " has other bytes under its tag " << tag;
        const std::uint64_t revision = std::stoull(reply["tessera-revision"]);
        EXPECT_GE(revision, page.touched) << page.address();
        EXPECT_LE(revision, page.near_touched) << page.address();
        if (!page.tag.empty()) ++(page.tag == tag ? kept : changed);
        page.tag = tag;
        page.bytes = reply.body;
    };
    for (Page& page : pages) look_at(page);

    for (int i = 0; i < edits; ++i) {
        const auto reply = send(*client, random.edit());
        ASSERT_TRUE(reply);
        if (reply->status == 200) {
            const proto::EditAnswer answer = answer_in(*reply);
            ASSERT_EQ(answer.revision(), static_cast<std::uint64_t>(++accepted));
            for (Page& page : pages)
                for (const proto::DirtyBox& box : answer.dirty()) {
                    if (page.meets(box, 0)) page.touched = answer.revision();
                    if (page.meets(box, 4 * max_gutter_texels)) page.near_touched = answer.revision();
                }
        } else {
            ASSERT_EQ(reply->status, 400) << reply->body;  // An id that is, or is not, there
        }
        look_at(pages[random.below(pages.size())]);
        if (i % 100 == 99)
            for (Page& page : pages) look_at(page);
        if (HasFailure()) return;
    }
    EXPECT_GT(accepted, edits / 5);
    EXPECT_GT(changed, 50);
    EXPECT_GT(kept, 50);

    // A server that has not lived through it, but read the journal: once after an end, once after a kill
    for (const int ending : {SIGTERM, SIGKILL}) {
        client.reset();
        program->signal(ending);
        program->exit_code();
        program.reset(new Program(serve({})));
        client.emplace(program->port());
        for (Page& page : pages) {
            const Reply reply = client->get(page.address()).value();
            EXPECT_EQ(reply["etag"], page.tag) << page.address();
            EXPECT_EQ(reply.body, page.bytes) << page.address();
        }
    }
}

}  // namespace
}  // namespace tessera
