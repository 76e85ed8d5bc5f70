#include "server/sampling/sampler_store.h"

#include <gtest/gtest.h>

#include "tests/unit/server/sampling/made_filters.h"

namespace tessera {
namespace {

using test::MadeFilters;
using test::scene_to_sample;

const SampleStep exact_on_fast{{.kind = FilterKind::exact}, Accuracy::fast},
    nearest_on_fast{{.kind = FilterKind::nearest}, Accuracy::fast},
    exact_on_exact{{.kind = FilterKind::exact}, Accuracy::exact};

class SamplerStoreTest : public testing::Test {
  protected:
    void use(const ScenePtr& scene, const SampleStep& step) { store.borrow(scene, ChannelSet::albedo, step); }

    MadeFilters made;
    SamplerStore store{{.memory_bytes = 1'000'000, .samplers = 3, .sources = 2}, made.makers()};
};

TEST_F(SamplerStoreTest, LendsWhatWasGivenBackAndSharesPages) {
    const ScenePtr scene = scene_to_sample();
    use(scene, exact_on_fast);
    use(scene, exact_on_fast);
    use(scene, nearest_on_fast);
    EXPECT_EQ(made.samplers_made, 2);
    EXPECT_EQ(made.pages_made, 1);
    use(scene, exact_on_exact);
    EXPECT_EQ(made.pages_made, 2);
    EXPECT_EQ(store.page_bytes(), 2000u);
}

TEST_F(SamplerStoreTest, ASamplerIsLentToOneAtATime) {
    const ScenePtr scene = scene_to_sample();
    {
        const auto one = store.borrow(scene, ChannelSet::albedo, exact_on_fast);
        const auto two = store.borrow(scene, ChannelSet::albedo, exact_on_fast);
        EXPECT_EQ(made.samplers_alive, 2);
    }
    EXPECT_EQ(store.idle_samplers(), 2u);
}

TEST_F(SamplerStoreTest, ForgetsWhatWasUsedLongestAgo) {
    const ScenePtr a = scene_to_sample("a"), b = scene_to_sample("b"), c = scene_to_sample("c");
    use(a, exact_on_fast);
    use(b, exact_on_fast);
    use(a, nearest_on_fast);
    use(c, exact_on_fast);  // b makes room
    EXPECT_EQ(store.sources(), 2u);
    EXPECT_EQ(made.samplers_alive, 3);
    use(a, exact_on_fast);
    EXPECT_EQ(made.samplers_made, 4);
    use(b, exact_on_fast);
    EXPECT_EQ(made.samplers_made, 5);
    EXPECT_LE(store.idle_samplers(), 3u);
}

TEST_F(SamplerStoreTest, KeepsNothingOfASceneThatIsServedNoMore) {
    const std::weak_ptr<const Scene> old = [&] {
        const ScenePtr scene = scene_to_sample();
        use(scene, exact_on_fast);
        return scene;
    }();
    EXPECT_FALSE(old.expired());
    use(scene_to_sample(), exact_on_fast);  // of the same name
    EXPECT_TRUE(old.expired());
    EXPECT_EQ(made.samplers_alive, 1);
    store.forget();
    EXPECT_EQ(made.samplers_alive, 0);
    EXPECT_EQ(store.sources(), 0u);
}

TEST_F(SamplerStoreTest, ASamplerThatIsLentWhenItsSceneGoesIsDroppedWhenItComesBack) {
    const ScenePtr scene = scene_to_sample();
    {
        const auto lent = store.borrow(scene, ChannelSet::albedo, exact_on_fast);
        store.forget();
        EXPECT_EQ(made.samplers_alive, 1);
    }
    EXPECT_EQ(made.samplers_alive, 0);
}

TEST_F(SamplerStoreTest, DividesItsMemory) {
    std::size_t pages = 0, sampler = 0;
    auto makers = made.makers();
    const auto make_pages = makers.pages;
    const auto make_sampler = makers.sampler;
    makers.pages = [&](auto texture, Accuracy accuracy, std::size_t bytes) {
        pages = bytes;
        return make_pages(std::move(texture), accuracy, bytes);
    };
    makers.sampler = [&](const FootprintFilter& filter, auto given, std::size_t bytes) {
        sampler = bytes;
        return make_sampler(filter, std::move(given), bytes);
    };
    SamplerStore divided{{.memory_bytes = 1'000'000, .samplers = 4, .sources = 2}, makers};
    divided.borrow(scene_to_sample(), ChannelSet::albedo, exact_on_fast);
    EXPECT_GT(pages, 0u);
    EXPECT_GT(sampler, 0u);
    EXPECT_LE(2 * pages + 4 * sampler, 1'000'000u);
}

}  // namespace
}  // namespace tessera
