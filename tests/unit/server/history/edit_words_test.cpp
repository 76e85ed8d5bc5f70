#include "server/history/edit_words.h"

#include <gtest/gtest.h>

#include "proto/edit.pb.h"

#include "shared/wire/json.h"

namespace tessera {
namespace {

std::string words_for_json(const std::string& json) {
    proto::Change change;
    EXPECT_TRUE(read_json(json, "change", change)) << json;
    return words_for(change);
}

TEST(EditWords, SayWhatAChangeDoes) {
    const std::pair<const char*, const char*> said[] = {
        {R"({"place_sprite": {"id": 3, "pattern": 2, "x": 10.5, "y": -4}})",
         "places sprite 3, pattern 2, at (10.5, -4)"},
        {R"({"move_sprite": {"id": 3, "x": 274877906943.25, "y": 0}})",
         "moves sprite 3 to (274877906943.25, 0)"},
        {R"({"move_sprite": {"id": 3, "y": 7}})", "moves sprite 3 to y 7"},
        {R"({"move_sprite": {"id": 3, "scale": 2, "turn": 0.25, "order": -1, "pattern": 0}})",
         "changes sprite 3, scale 2, turn 0.25, order -1, pattern 0"},
        {R"({"remove_sprite": {"id": 18446744073709551615}})", "removes sprite 18446744073709551615"},
        {R"({"paint_map": {"block": "areas", "x": 4, "y": 5, "width": 2, "height": 3, "value": 1}})",
         "paints 2 × 3 entries of areas at (4, 5) with 1"},
        {R"({"paint_map": {"block": "areas", "width": 1, "height": 1, "values": "AAA=", "mask": "AQ=="}})",
         "paints 1 × 1 entries of areas at (0, 0), masked"},
        {R"({"set_parameter": {"block": "noise", "field": "count", "value": {"integer": 7}}})",
         "sets count of noise to 7"},
        {R"({"set_parameter": {"field": "seed", "value": {"block": "other"}}})", "sets seed to block other"},
        {R"({"change_animation": {"block": "led", "step": 100, "rest": {"number": 0.5}, "density": 2}})",
         "changes the animation of led, from step 100, rest 0.5, density 2"},
        {R"({"set_target": {"id": 1, "x": -5, "y": 6}})", "sets target 1 at (-5, 6)"},
        {R"({"remove_target": {"id": 1}})", "removes target 1"},
        {R"({"set_clock": {"playing": false, "step": 12}})", "stops the clock, sets the clock to step 12"},
        {"{}", "something that this program does not know"},
    };
    for (const auto& [json, words] : said) EXPECT_EQ(words_for_json(json), words);
}

TEST(EditWords, CountWhatIsTooMuchToSay) {
    proto::Edit edit;
    for (std::uint64_t id = 1; id <= 5; ++id) edit.add_changes()->mutable_remove_sprite()->set_id(id);
    EXPECT_EQ(words_for(edit), "removes sprite 1; removes sprite 2; removes sprite 3; and 2 changes more");
}

TEST(EditWords, HoldNothingThatATerminalObeys) {
    EXPECT_EQ(words_for_json(R"({"remove_target": {"id": 1}})"), "removes target 1");
    EXPECT_EQ(
        words_for_json("{\"set_parameter\": {\"block\": \"\\u001b[2J\\n\\u009b1m\", \"field\": \"é\"}}"),
        "sets é of ?[2J???1m to nothing");
    EXPECT_EQ(harmless("Zoë\x7f"), "Zoë?");
}

TEST(EditWords, TellTheTimeInUtc) {
    EXPECT_EQ(text_of(JournalTime{std::chrono::milliseconds{0}}), "1970-01-01 00:00:00.000");
    EXPECT_EQ(text_of(JournalTime{std::chrono::milliseconds{1'795'356'185'120}}), "2026-11-22 14:03:05.120");
}

}  // namespace
}  // namespace tessera
