// A client that flies, leaps and turns for thousands of frames, over a link that loses, repeats and reorders,
// while others edit, the connection breaks, scenes are replaced and the cache is resized. After each frame
// all that the GPU would hold is checked.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "client/residency/residency.h"
#include "tests/simulation/simulated_stream.h"

namespace tessera {
namespace {

using testing::SimulatedStream;

/// What a page's texels say.
struct Content {
    PageKey page;
    std::uint32_t history = 0;
    std::uint64_t revision = 0;
};

std::string paint(PageKey page, std::uint32_t history, std::uint64_t revision) {
    const Content content{page, history, revision};
    std::string texels(slot_bytes, '\0');
    std::memcpy(texels.data(), &content, sizeof content);
    return texels;
}

class Life {
  public:
    Life(Extent extent, const testing::LinkSettings& link, std::size_t slots, unsigned seed)
        : extent_{extent},
          random_{seed},
          stream{link, paint, seed},
          residency{extent, stream, {.slots = slots}},
          gpu_(slots) {}

    void frame() {
        now_ += ClientTime{16};
        live();
        stream.advance(now_);
        const PlaneView view{camera_, 640, 480};
        outcome = residency.update(view, now_);
        for (const SlotUpload& upload : outcome.uploads) {
            Content content;
            std::memcpy(&content, upload.texels.data(), sizeof content);
            gpu_[upload.slot] = content;
        }
        check(view);
    }

    ResidencyFrame outcome;

  private:
    double uniform(double low, double high) { return std::uniform_real_distribution{low, high}(random_); }
    bool one_in(unsigned count) { return random_() % count == 0; }

    void live() {
        const std::int64_t side = extent_.side_texels();
        if (frames_++ == 0 || one_in(150)) {
            camera_.ground = PlanePoint{}.moved(std::floor(uniform(0, static_cast<double>(side) - 1)),
                                                std::floor(uniform(0, static_cast<double>(side) - 1)));
            camera_.height_texels = std::exp2(uniform(6, 13));
        }
        const double stride = camera_.height_texels / 5;
        const PlanePoint moved = camera_.ground.moved(uniform(-stride, stride), uniform(-stride, stride));
        if (moved.x >= 0 && moved.y >= 0 && moved.x < side && moved.y < side) camera_.ground = moved;
        camera_.yaw_degrees += uniform(-10, 10);
        camera_.pitch_degrees = std::clamp(camera_.pitch_degrees + uniform(-4, 4), -90.0, 2.0);
        if (one_in(4)) edit();
        if (one_in(400)) stream.disconnect(uniform(50, 800), !one_in(3));
        if (one_in(900)) stream.replace_scene();
        if (one_in(300)) resize();
    }

    void edit() {
        std::vector<PageKey> dirty;
        for (const auto& [page, slot] : residency.cache().pages())
            if (one_in(12)) dirty.push_back(page);
        stream.edit(dirty);
    }

    void resize() {
        const SlotCache::Resized resized = residency.resize(48 + random_() % 160);
        const std::vector<Content> before = gpu_;
        gpu_.assign(residency.cache().capacity(), {});
        std::copy_n(before.begin(), std::min(before.size(), gpu_.size()), gpu_.begin());
        for (const SlotCache::Move& move : resized.moves) gpu_[move.to] = before[move.from];
    }

    void check(const PlaneView& view) {
        // One page in a slot, one slot for a page, and what is in it is what residency believes
        std::set<Slot> slots;
        for (const auto& [page, slot] : residency.cache().pages()) {
            ASSERT_TRUE(slots.insert(slot).second) << "two pages in slot " << slot;
            ASSERT_LT(slot, residency.cache().capacity());
            ASSERT_EQ(gpu_[slot].page, page) << "frame " << frames_;
            const PageVersion* held = residency.versions().held(page);
            ASSERT_TRUE(held);
            ASSERT_EQ(gpu_[slot].revision, held->revision);
            ASSERT_EQ(gpu_[slot].history, held->history);
            const auto shown = residency.table().shown_for(page);
            ASSERT_TRUE(shown);
            ASSERT_EQ(shown->slot, slot);
            ASSERT_EQ(shown->level, page.level);
        }
        // No page goes back to an older version
        for (const auto& [page, slot] : residency.cache().pages()) {
            auto& best = committed_[page];
            const std::pair version{gpu_[slot].history, gpu_[slot].revision};
            ASSERT_GE(version, best) << "frame " << frames_;
            best = version;
        }
        // Something is shown everywhere once the coarsest page has come
        has_cover_ = has_cover_ || residency.cache().find({extent_.n, 0, 0}).has_value();
        for (const NeededPage& page : needed_pages(view, extent_, outcome.lod_bias)) {
            ASSERT_TRUE(!has_cover_ || residency.table().shown_for(page.key)) << "frame " << frames_;
        }
        // Requests
        ASSERT_EQ(stream.duplicate_requests, 0u);
        ASSERT_EQ(stream.over_allowance, 0u);
        for (const PageRequest& request : stream.asked) {
            ASSERT_TRUE(extent_.contains(request.page));
            ASSERT_LE(request.least_revision, stream.scene_revision()) << "none from a scene that is over";
        }
        stream.asked.clear();
    }

    Extent extent_;
    std::mt19937_64 random_;

  public:
    SimulatedStream stream;
    Residency residency;
    /// The truth, for each page that the view samples.
    void expect_current() {
        for (const NeededPage& page : needed_pages(PlaneView{camera_, 640, 480}, extent_, outcome.lod_bias)) {
            const auto shown = residency.table().shown_for(page.key);
            ASSERT_TRUE(shown);
            ASSERT_EQ(shown->level, page.key.level);
            ASSERT_EQ(gpu_[shown->slot].revision, stream.revision_of(page.key));
            ASSERT_EQ(gpu_[shown->slot].history, stream.history());
        }
    }
    void rest() {
        now_ += ClientTime{16};
        stream.advance(now_);
        const PlaneView view{camera_, 640, 480};
        outcome = residency.update(view, now_);
        for (const SlotUpload& upload : outcome.uploads)
            std::memcpy(&gpu_[upload.slot], upload.texels.data(), sizeof(Content));
        check(view);
    }

  private:
    Camera camera_{.pitch_degrees = -40};
    ClientTime now_{};
    int frames_ = 0;
    bool has_cover_ = false;
    std::vector<Content> gpu_;
    std::map<PageKey, std::pair<std::uint32_t, std::uint64_t>> committed_;
};

class Residencies : public ::testing::TestWithParam<int> {};

TEST_P(Residencies, HoldWhatTheyShouldInEveryFrameOfAHardLife) {
    const int n = GetParam();
    Life life{
        Extent{static_cast<std::uint8_t>(n)},
        {.bytes_per_second = 6e6, .one_way_ms = 15, .loss = 0.01, .duplicates = 0.05, .most_delay_ms = 60},
        n == 30 ? 200u : 72u,
        static_cast<unsigned>(n)};
    for (int frame = 0; frame < 2500; ++frame) {
        life.frame();
        if (HasFatalFailure()) return;
    }
    if (n > 2) {  // the smallest has 21 pages, which soon are all there
        EXPECT_GT(life.residency.cache().evictions(), 100u);
        EXPECT_GT(life.residency.requests().counts().failed, 5u);
    }
    EXPECT_GT(life.residency.requests().counts().unasked, 10u) << "duplicates";
    // Then peace: everything in view becomes sharp and current
    int frames = 0;
    do {
        life.rest();
        if (HasFatalFailure()) return;
    } while (!life.outcome.is_current() && ++frames < 4000);
    EXPECT_LT(frames, 4000);
    life.expect_current();
}

INSTANTIATE_TEST_SUITE_P(Extents, Residencies, ::testing::Values(30, 14, 2));

}  // namespace
}  // namespace tessera
