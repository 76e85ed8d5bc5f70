// Only pages that are shown have line integrals. The picture is the one that it would be if all had: drawn
// both ways, and compared byte by byte, while the camera flies and leaps, pages come late and are evicted,
// others edit, columns change, and the cache is resized.
#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "client/residency/page_source.h"
#include "tests/simulation/simulated_stream.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

using testing::LinkSettings;
using testing::SimulatedStream;

/// Blocks of 8 texels in colours of their own, by page and version.
std::string blocks(PageKey page, std::uint32_t history, std::uint64_t revision) {
    std::string texels(slot_bytes, '\xff');
    std::mt19937 random{page.level * 7919u + page.x * 31u + page.y * 1009u + history * 77u +
                        static_cast<unsigned>(revision) * 13u};
    constexpr std::size_t wide = slot_side_texels / 8 + 1;
    std::vector<std::uint32_t> colours(wide * wide);
    for (std::uint32_t& colour : colours) colour = static_cast<std::uint32_t>(random());
    for (std::size_t y = 0; y < slot_side_texels; ++y)
        for (std::size_t x = 0; x < slot_side_texels; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                texels[(y * slot_side_texels + x) * 4 + c] =
                    static_cast<char>(colours[y / 8 * wide + x / 8] >> (8 * c));
    return texels;
}

class PageIntegralsTest : public ::testing::TestWithParam<Surface::Kind> {};

TEST_P(PageIntegralsTest, ShowTheSameAsIfAllPagesHadThem) {
    const auto context = testing::headless_context();
    constexpr int width = 220, height = 180;
    const Extent extent{20};
    SimulatedStream stream{{.bytes_per_second = 40e6, .one_way_ms = 10, .most_delay_ms = 20}, blocks, 3};
    FrameTarget target{width, height};
    auto scene = PlaneScene::make(extent, stream, {.slots = 150, .stand_ins = 8});
    ASSERT_TRUE(scene);
    PlaneRenderer renderer{extent};
    std::mt19937 random{11};
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    Camera camera;
    ClientTime now{};
    std::size_t most_places = 0, unsharp = 0;
    std::unique_ptr<IntegralStore> all;
    for (int frame = 0; frame < 40; ++frame) {
        if (frame % 12 == 0) {
            camera.ground =
                PlanePoint{}.moved(std::floor(uniform(1e6, 2.6e8)), std::floor(uniform(1e6, 2.6e8)));
            camera.height_texels = std::exp2(uniform(7, 12));
            camera.pitch_degrees = uniform(-70, -5);
        }
        if (frame == 25) {
            ASSERT_TRUE((*scene)->resize(120));
        }
        camera.yaw_degrees += uniform(-15, 15);
        camera.ground = camera.ground.moved(uniform(-1, 1) * camera.height_texels, 0);
        const PlaneView view{camera, width, height, around({.kind = GetParam()}, camera)};
        const FilterChoice filter{Filter::line_integral, 4, frame % 7 == 6 ? 24 : frame % 5 == 4 ? 2 : 6};
        ResidencyFrame outcome;
        for (int i = 0; i < 5; ++i) {
            now += ClientTime{16};
            if (random() % 9 == 0) {
                std::vector<PageKey> dirty;
                for (const auto& [page, slot] : (*scene)->residency().cache().pages())
                    if (random() % 4 == 0) dirty.push_back(page);
                stream.edit(dirty);
            }
            stream.advance(now);
            // Other filters come between: their pages bring no sums
            outcome = (*scene)->update(view, now, frame % 6 == 5 && i == 2 ? FilterChoice{} : filter);
        }
        unsharp += outcome.is_sharp() ? 0 : 1;
        const PlaneStyle style{.filter = filter};
        ASSERT_TRUE((*scene)->draw(target, view, style));
        const Rgba8Image shown = target.read();
        most_places = std::max(most_places, (*scene)->integral_places());

        if (!all || frame == 25) {
            auto made = IntegralStore::make((*scene)->residency().slots());
            ASSERT_TRUE(made);
            all = std::move(*made);
        }
        for (const auto& [page, slot] : (*scene)->residency().cache().pages())
            all->upload_from((*scene)->pages().coded_texture(), gutter_texels, slot, slot);
        PlaneStyle same = style;
        same.lod_bias = outcome.lod_bias;
        same.now_ms = static_cast<std::uint32_t>(now.count());
        ASSERT_TRUE(renderer.draw(target, view,
                                  {.colour = (*scene)->pages().texture(),
                                   .coded = (*scene)->pages().coded_texture(),
                                   .table = (*scene)->page_table().texture(),
                                   .entries = (*scene)->page_table().entries(),
                                   .integrals = all->texture(),
                                   .integral_table = (*scene)->page_table().texture()},
                                  (*scene)->residency().settings().window_side, same));
        ASSERT_EQ(shown, target.read()) << "frame " << frame;
    }
    std::cout << name_of(GetParam()) << ": at most " << most_places << " places, " << unsharp
              << " frames not sharp\n";
    EXPECT_GT(unsharp, 5u);
    EXPECT_LT(unsharp, 36u);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, PageIntegralsTest,
                         ::testing::Values(Surface::Kind::plane, Surface::Kind::terrain,
                                           Surface::Kind::corridor),
                         [](const auto& test) { return std::string{name_of(test.param)}; });

TEST(PlaneScene, SaysWhereTheDriverHasNoRoomForItsCache) {
    const auto context = testing::headless_context();
    SimulatedStream stream{{}, blocks};
    const auto scene = PlaneScene::make(Extent{20}, stream, {.slots = 60'000});
    ASSERT_FALSE(scene);
    EXPECT_NE(scene.error().detail.find("cache of 60032 pages"), std::string::npos) << scene.error().detail;
}

TEST(PageIntegrals, TakeRoomForWhatIsShownAndNotForTheCache) {
    const auto context = testing::headless_context();
    SimulatedStream stream{{}, blocks, 3};
    FrameTarget target{200, 175};
    auto scene = PlaneScene::make(Extent{20}, stream, {});
    ASSERT_TRUE(scene);
    const FilterChoice filter{Filter::line_integral, 4, 6};
    Camera camera{.ground = {1 << 24, 1 << 24}, .height_texels = 900, .pitch_degrees = -50};
    ClientTime now{};
    for (int i = 0; i < 300; ++i) {
        now += ClientTime{16};
        camera.ground = camera.ground.moved(200, 0);
        stream.advance(now);
        const PlaneView view{camera, 200, 175};
        const ResidencyFrame frame = (*scene)->update(view, now, filter);
        ASSERT_TRUE((*scene)->draw(target, view, {.filter = filter}));
        ASSERT_LE((*scene)->integral_places(), std::max<std::size_t>(64, 2 * frame.needed));
    }
    EXPECT_GT((*scene)->residency().cache().size(), 200u) << "all that the camera has passed";
    EXPECT_EQ((*scene)->gpu_bytes(),
              (*scene)->pages().bytes() + (*scene)->integral_places() * IntegralStore::page_bytes);
}

}  // namespace
}  // namespace tessera
