#include "shared/revisions/edit_id.h"

#include <string>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(EditIds, AreUuidsForPeople) {
    const EditId id = edit_id_from("F81D4FAE-7dec-41d0-a765-00a0c91e6bf6").value();
    EXPECT_EQ(to_string(id), "f81d4fae-7dec-41d0-a765-00a0c91e6bf6");
    EXPECT_EQ(edit_id_from("f81d4fae7dec41d0a76500a0c91e6bf6"), id);
    for (const char* wrong : {"", "f81d4fae", "f81d4fae7dec41d0a76500a0c91e6bf",
                              "f81d4fae7dec41d0a76500a0c91e6bfg", "f81d4fae-7dec-41d0-a76500-a0c91e6bf6",
                              "f81d4fae7dec41d0a76500a0c91e6bf6 ", "------------------------------------"})
        EXPECT_FALSE(edit_id_from(wrong)) << wrong;
}

TEST(EditIds, AreDrawnAsUuidsOfVersion4) {
    for (int i = 0; i < 100; ++i) {
        const std::string text = to_string(random_edit_id());
        EXPECT_EQ(text[14], '4') << text;
        EXPECT_NE(std::string{"89ab"}.find(text[19]), std::string::npos) << text;
    }
    EXPECT_NE(random_edit_id(), random_edit_id());
}

}  // namespace
}  // namespace tessera
