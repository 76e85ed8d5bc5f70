#include "client/view/viewer_state.h"

#include <gtest/gtest.h>

#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera {
namespace {

TEST(CursorReading, NamesTexelLevelAndPageAndSaysWhatIsShownThere) {
    testing::FakePageSource source{testing::blank_page};
    source.capacity = 1;  // the coarsest page comes first, alone
    Residency residency{Extent{20}, source, {}};
    // One pixel is one texel: level 0, straight below the eye
    const Camera camera{.ground = {10'000'000, 20'000'000, 0.5, 0.5},
                        .height_texels = 350 / std::tan(25 * 3.14159265358979 / 180),
                        .pitch_degrees = -90};
    const PlaneView view{camera, 800, 700};
    residency.update(view, ClientTime{1});
    residency.update(view, ClientTime{17});
    auto reading = read_cursor(view, residency, 0, 400, 350);
    ASSERT_TRUE(reading);
    EXPECT_EQ(reading->texel.x, 10'000'000);
    EXPECT_EQ(reading->texel.y, 20'000'000);
    EXPECT_NEAR(reading->level, 0, 1e-6);
    EXPECT_EQ(reading->page, (PageKey{0, 10'000'000 / 256, 20'000'000 / 256}));
    EXPECT_EQ(page_state(*reading).substr(0, 17), "20 levels coarser");
    for (int frame = 2; frame < 200; ++frame) residency.update(view, ClientTime{16 * frame});
    reading = read_cursor(view, residency, 0, 400, 350);
    EXPECT_EQ(page_state(*reading), "sharp");
}

TEST(CursorReading, IsNothingOnTheSkyAndBeyondTheExtent) {
    testing::FakePageSource source{testing::blank_page};
    Residency residency{Extent{1}, source, {}};
    const Camera camera{.ground = {10, 10, 0, 0}, .height_texels = 1000, .pitch_degrees = 0};
    EXPECT_FALSE(read_cursor(PlaneView{camera, 800, 700}, residency, 0, 400, 100));
    EXPECT_FALSE(read_cursor(PlaneView{camera, 800, 700}, residency, 0, 400, 690));
}

}  // namespace
}  // namespace tessera
