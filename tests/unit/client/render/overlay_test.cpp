#include "client/render/overlay.h"

#include <gtest/gtest.h>

#include "client/render/page_marks.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

using testing::Offscreen;

const Camera straight_down{
    .ground = {500'000, 500'000, 0.5, 0.5}, .height_texels = 300, .pitch_degrees = -90};

double mean_of(const Rgba8Image& image, int channel) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) sum += image.row(y)[4 * x + channel];
    return sum / image.width / image.height;
}

TEST(Overlays, TintNewPagesRedAndOldOnesBlue) {
    Offscreen offscreen{Extent{14}, testing::blank_page, 120, 100};
    offscreen.settle(straight_down);
    const Rgba8Image fresh = offscreen.draw(straight_down, {.overlay = Overlay::age});
    offscreen.now += ClientTime{200'000};
    offscreen.update(straight_down);
    const Rgba8Image old = offscreen.draw(straight_down, {.overlay = Overlay::age});
    EXPECT_GT(mean_of(fresh, 0), mean_of(fresh, 2) + 20);
    EXPECT_GT(mean_of(old, 2), mean_of(old, 0) + 20);
}

TEST(Overlays, LeaveWhatNobodyEditedAsItIsButForItsBorders) {
    Offscreen offscreen{Extent{14}, testing::blank_page, 120, 100};
    offscreen.settle(straight_down);
    const Rgba8Image plain = offscreen.draw(straight_down),
                     marked = offscreen.draw(straight_down, {.overlay = Overlay::revision});
    int others = 0;
    for (int y = 0; y < plain.height; ++y)
        for (int x = 0; x < plain.width; ++x)
            others +=
                std::equal(plain.row(y) + 4 * x, plain.row(y) + 4 * x + 3, marked.row(y) + 4 * x) ? 0 : 1;
    EXPECT_LT(others, plain.width * plain.height / 10);
}

TEST(Overlays, RankPagesByTheEditsSinceTheirs) {
    EXPECT_EQ(mark_of(0, 50), -1);
    EXPECT_EQ(mark_of(50, 50), 0);
    EXPECT_GT(mark_of(40, 50), mark_of(49, 50));
    EXPECT_EQ(mark_of(1, 100'000), 1);
}

TEST(Overlays, AreNamedForPeople) {
    for (const Overlay overlay : overlays) EXPECT_EQ(overlay_named(name_of(overlay)), overlay);
    EXPECT_FALSE(overlay_named("heat"));
}

}  // namespace
}  // namespace tessera
