#include "shared/page/channel_set.h"

#include <string>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ChannelSet, IsFoundByItsOwnNameAndNoOther) {
    for (const ChannelSet set : channel_sets) {
        EXPECT_EQ(channel_set_named(name_of(set)), set);
        EXPECT_EQ(channel_set_named(std::string{name_of(set)} + "s"), std::nullopt);
    }
    for (const char* name : {"", "Albedo", "color", "normal "})
        EXPECT_EQ(channel_set_named(name), std::nullopt);
}

}  // namespace
}  // namespace tessera
