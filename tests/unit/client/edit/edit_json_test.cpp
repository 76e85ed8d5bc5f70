#include "client/edit/edit_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

proto::EditAnswer answer_with_inverse(std::uint64_t sprite) {
    proto::EditAnswer answer;
    answer.set_revision(5);
    answer.mutable_inverse()->set_id("of another time");
    answer.mutable_inverse()->set_known_revision(3);
    answer.mutable_inverse()->add_changes()->mutable_remove_sprite()->set_id(sprite);
    return answer;
}

TEST(EditJson, AnAnswersLineIsWhatUndoReads) {
    const std::string first = json_line(told_fate("a", answer_with_inverse(7)));
    const std::string second = json_line(told_fate("b", answer_with_inverse(8)));
    EXPECT_EQ(first.find('\n'), std::string::npos);
    EXPECT_THAT(first, HasSubstr(R"("revision":"5")"));
    proto::EditRefused refusal;
    refusal.set_id("c");
    const auto undo =
        undo_in(first + "\n" + second + "\n\n" + json_line(told_fate(refusal)) + "\r\n", "done.jsonl");
    ASSERT_TRUE(undo) << undo.error().detail;
    EXPECT_EQ(undo->changes(0).remove_sprite().id(), 8u) << "the last edit that was made";
    EXPECT_EQ(undo->id(), "") << "an edit of its own";
    EXPECT_EQ(undo->known_revision(), 0u);
}

TEST(EditJson, WhatIsNoAnswerIsNamed) {
    EXPECT_THAT(undo_in("", "here").error().detail, HasSubstr("here: no answer of an edit"));
    EXPECT_THAT(undo_in("garbage", "here").error().detail, HasSubstr("here: "));
    EXPECT_THAT(undo_in(json_line(told_fate("a", {})), "here").error().detail, HasSubstr("no inverse"));
}

TEST(EditJson, AnEditHasChangesThatAreKnown) {
    EXPECT_TRUE(edit_in(R"({"changes": [{"remove_sprite": {"id": 7}}]})", "line 1"));
    EXPECT_THAT(edit_in("{}", "line 2").error().detail, HasSubstr("line 2: the edit has no changes"));
    EXPECT_THAT(edit_in(R"({"changes": [{"eat_sprite": {}}]})", "line 3").error().detail,
                HasSubstr("eat_sprite"));
}

TEST(EditJson, AFileHasALimit) {
    EXPECT_THAT(text_of("/dev/zero", 1000).error().detail, HasSubstr("more than 1000 bytes"));
    EXPECT_EQ(text_of("/no/such/file", 1000).error().code, ErrorCode::io_failure);
}

}  // namespace
}  // namespace tessera
