#include "client/link/page_url.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(PageUrl, CountsZoomFromTheCoarsestLevel) {
    EXPECT_EQ(page_target("pebbles", Extent{20}, {.level = 3, .x = 5, .y = 9}, {.format = PageFormat::png}),
              "/scenes/pebbles/17/5/9.png");
    EXPECT_EQ(page_target("pebbles", Extent{20}, {.level = 20, .x = 0, .y = 0}, {}),
              "/scenes/pebbles/0/0/0.rgba");
}

TEST(PageUrl, NamesOnlyWhatIsNotTheDefaultInOneOrder) {
    EXPECT_EQ(page_target("s", Extent{1}, {}, {PageFormat::webp, 4, Accuracy::exact}),
              "/scenes/s/1/0/0.webp?gutter=4&accuracy=exact");
    EXPECT_EQ(page_target("s", Extent{1}, {}, {PageFormat::jpg, 4, Accuracy::high}),
              "/scenes/s/1/0/0.jpg?gutter=4");
    EXPECT_EQ(page_target("s", Extent{1}, {}, {PageFormat::png, 0, Accuracy::high, ChannelSet::normal}),
              "/scenes/s/1/0/0.png?channels=normal");
    EXPECT_EQ(page_target("s", Extent{1}, {}, {PageFormat::png, 4, Accuracy::fast, ChannelSet::height}),
              "/scenes/s/1/0/0.png?gutter=4&accuracy=fast&channels=height");
}

TEST(PageUrl, EncodesASceneThatTriesToLeaveItsSegment) {
    EXPECT_EQ(scene_target("../a b?ü"), "/scenes/..%2Fa%20b%3F%C3%BC");
}

TEST(PageUrl, KnowsTheEndingsOfItsFormats) {
    EXPECT_EQ(page_format("jpg"), PageFormat::jpg);
    EXPECT_EQ(page_format("gif"), std::nullopt);
}

}  // namespace
}  // namespace tessera
