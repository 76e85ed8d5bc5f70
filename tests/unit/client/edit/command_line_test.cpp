#include "client/edit/command_line.h"

#include <iterator>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/edit/edit_words.h"

namespace tessera {
namespace {

using testing::HasSubstr;

EditCommandLine read(std::vector<const char*> words) {
    words.insert(words.begin(), {"tessera-edit", "http://127.0.0.1:7070", "road"});
    return read_edit_command_line(static_cast<int>(words.size()), words.data());
}

const proto::Change& change_of(const EditCommandLine& line) { return line.options.edit.changes(0); }

TEST(CommandLine, EachCommandMakesItsChange) {
    const auto place = read({"--name", "Ada", "place", "4000", "-2.5", "--pattern", "2", "--id", "7"});
    ASSERT_TRUE(place.go_on);
    EXPECT_EQ(place.options.server.port, 7070);
    EXPECT_EQ(place.options.edit.author(), "Ada");
    EXPECT_EQ(change_of(place).place_sprite().id(), 7u);
    EXPECT_EQ(change_of(place).place_sprite().y(), -2.5);
    EXPECT_NE(change_of(read({"place", "1", "2"})).place_sprite().id(), 0u) << "one is drawn";
    const auto move = read({"move", "7", "--turn", "0.25"});
    EXPECT_FALSE(change_of(move).move_sprite().has_x());
    EXPECT_EQ(change_of(move).move_sprite().turn(), 0.25);
    EXPECT_EQ(read({"remove", "7", "8"}).options.edit.changes_size(), 2);
    EXPECT_EQ(change_of(read({"set", "flowers", "count", "12"})).set_parameter().value().integer(), 12);
    EXPECT_EQ(change_of(read({"set", "flowers", "x", "0.5"})).set_parameter().value().number(), 0.5);
    EXPECT_EQ(change_of(read({"set", "flowers", "x", "drift"})).set_parameter().value().block(), "drift");
    EXPECT_EQ(change_of(read({"animate", "led", "--density", "0.8"})).change_animation().density(), 0.8);
    EXPECT_EQ(change_of(read({"target", "3", "10", "-20"})).set_target().y(), -20);
    EXPECT_EQ(change_of(read({"target", "3", "--remove"})).remove_target().id(), 3u);
    const auto clock = read({"clock", "pause", "--step", "-100"});
    EXPECT_TRUE(change_of(clock).set_clock().has_playing());
    EXPECT_FALSE(change_of(clock).set_clock().playing());
    EXPECT_EQ(change_of(clock).set_clock().step(), -100);
    EXPECT_FALSE(change_of(clock).set_clock().has_steps_per_second());
}

TEST(CommandLine, ADiscIsAMaskOfTheRectangle) {
    const auto paint = read({"paint", "areas", "10", "20", "4", "4", "-1", "--disc"});
    ASSERT_TRUE(paint.go_on);
    const proto::MapPaint& map = change_of(paint).paint_map();
    EXPECT_EQ(map.value(), -1);
    EXPECT_EQ(map.mask(), "\xf6\x6f") << "a square without its corners";
    EXPECT_TRUE(change_of(read({"paint", "areas", "0", "0", "4", "4", "1"})).paint_map().mask().empty());
}

TEST(CommandLine, WatchKnowsItsWindowsAndItsEnd) {
    const auto watch = read({"watch", "--window", "3:4,5,6,7", "--edits", "2", "--seconds", "1.5"});
    ASSERT_TRUE(watch.go_on);
    EXPECT_EQ(watch.options.task, EditOptions::Task::watch);
    EXPECT_EQ(watch.options.windows.at(0).level(), 3u);
    EXPECT_EQ(watch.options.windows.at(0).y1(), 7);
    EXPECT_EQ(watch.options.edits, 2u);
    EXPECT_EQ(watch.options.seconds, std::chrono::milliseconds{1500});
}

TEST(CommandLine, WhatIsWrongEndsWithTwo) {
    const std::vector<std::vector<const char*>> wrong{{},
                                                      {"jump"},
                                                      {"place", "1"},
                                                      {"move", "7", "1"},
                                                      {"paint", "areas", "0", "0", "60000", "60000", "1"},
                                                      {"animate", "led"},
                                                      {"target", "3", "1"},
                                                      {"clock"},
                                                      {"clock", "stop"},
                                                      {"watch", "--window", "3:4,5,6"},
                                                      {"watch", "--window", "3:4,5,4,7"},
                                                      {"apply", "no-such-file"},
                                                      {"--token-file", "no-such-file", "lines"}};
    for (const auto& words : wrong) {
        testing::internal::CaptureStderr();
        const auto line = read(words);
        EXPECT_FALSE(testing::internal::GetCapturedStderr().empty());
        EXPECT_FALSE(line.go_on);
        EXPECT_EQ(line.exit_code, 2) << (words.empty() ? "nothing" : words.front());
    }
}

TEST(CommandLine, EachCommandShowsAUsageThatCanBeTypedAndExamplesThatAreRight) {
    for (const std::string command : {"place", "move", "remove", "paint", "set", "animate", "target", "clock",
                                      "apply", "undo", "lines", "watch"}) {
        const std::vector<const char*> words{"tessera-edit", command.c_str(), "--help"};
        testing::internal::CaptureStdout();
        const auto help = read_edit_command_line(static_cast<int>(words.size()), words.data());
        const std::string text = testing::internal::GetCapturedStdout();
        EXPECT_FALSE(help.go_on);
        EXPECT_EQ(help.exit_code, 0);
        EXPECT_THAT(text, HasSubstr("Usage: tessera-edit URL SCENE " + command));
        testing::internal::CaptureStdout();
        EXPECT_EQ(read({command.c_str(), "--help"}).exit_code, 0);
        EXPECT_EQ(testing::internal::GetCapturedStdout(), text) << "with or without URL and SCENE";

        // What can be read without files is read
        std::istringstream lines{text};
        int examples = 0;
        for (std::string line; std::getline(lines, line);) {
            if (!line.starts_with("  tessera-edit http")) continue;
            ++examples;
            if (command == "apply" || command == "undo" || command == "lines") continue;
            std::istringstream in{line};
            std::vector<std::string> parts{std::istream_iterator<std::string>{in}, {}};
            std::vector<const char*> arguments;
            for (const std::string& part : parts) arguments.push_back(part.c_str());
            EXPECT_TRUE(read_edit_command_line(static_cast<int>(arguments.size()), arguments.data()).go_on)
                << line;
        }
        EXPECT_GE(examples, 1) << command;
    }
}

TEST(CommandLine, ACommandWithoutUrlAndSceneIsToldWhereTheyStand) {
    const std::vector<const char*> words{"tessera-edit", "place", "1", "2"};
    testing::internal::CaptureStderr();
    EXPECT_EQ(read_edit_command_line(static_cast<int>(words.size()), words.data()).exit_code, 2);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("URL and SCENE come first"));
}

TEST(EditWords, SayWhatBecameOfAnEdit) {
    const auto move = read({"move", "7", "4100", "2500.5", "--scale", "2"});
    proto::EditAnswer answer;
    answer.set_revision(8);
    EXPECT_EQ(words_of(move.options.edit, answer), "revision 8: move sprite 7 to (4100, 2500.5), scale 2");
    answer.add_effects()->set_step(120);
    EXPECT_THAT(words_of(move.options.edit, answer), HasSubstr("in effect from step 120"));
    proto::EditRefused refusal;
    refusal.set_why(proto::EditRefused::conflict);
    refusal.set_detail("the scene is at revision 9");
    EXPECT_EQ(words_of(read({"remove", "1", "2"}).options.edit, refusal),
              "2 changes: conflict: the scene is at revision 9");
}

}  // namespace
}  // namespace tessera
