// What a window tells of mouse and keys, on frames that the test makes as slow as it likes.
#include "client/view/window_events.h"

#include <random>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(WindowEvents, ATapBetweenTwoFramesIsDownForOne) {
    WindowEvents events;
    for (int tap = 0; tap < 3; ++tap) {
        events.key(GLFW_KEY_M, true);
        events.key(GLFW_KEY_M, false);
        events.button(GLFW_MOUSE_BUTTON_LEFT, true);
        events.button(GLFW_MOUSE_BUTTON_LEFT, false);
    }
    int taps = 0, clicks = 0;
    for (int frame = 0; frame < 12; ++frame) {
        const bool was_down = events.is_down(GLFW_KEY_M);
        const bool was_pressed = events.is_button_down(GLFW_MOUSE_BUTTON_LEFT);
        events.next_frame();
        taps += events.is_down(GLFW_KEY_M) && !was_down ? 1 : 0;
        clicks += events.is_button_down(GLFW_MOUSE_BUTTON_LEFT) && !was_pressed ? 1 : 0;
    }
    EXPECT_EQ(taps, 3);
    EXPECT_EQ(clicks, 3);
    EXPECT_FALSE(events.is_down(GLFW_KEY_M));
    EXPECT_FALSE(events.is_button_down(GLFW_MOUSE_BUTTON_LEFT));
}

TEST(WindowEvents, APressIsWhereTheCursorWasAndADragEndsWhereItWasLetGo) {
    WindowEvents events;
    events.move(10, 20);
    events.button(GLFW_MOUSE_BUTTON_LEFT, true);
    events.move(50, 60);
    events.move(300, 400);
    events.button(GLFW_MOUSE_BUTTON_LEFT, false);
    events.move(900, 900);

    events.next_frame();
    EXPECT_TRUE(events.is_button_down(GLFW_MOUSE_BUTTON_LEFT));
    EXPECT_EQ(events.cursor().x, 10);
    EXPECT_EQ(events.cursor().y, 20);
    for (const bool is_held : {true, false}) {  // there before it is let go
        events.next_frame();
        EXPECT_EQ(events.is_button_down(GLFW_MOUSE_BUTTON_LEFT), is_held);
        EXPECT_EQ(events.cursor().x, 300);
        EXPECT_EQ(events.cursor().y, 400);
    }
    events.next_frame();
    EXPECT_EQ(events.cursor().x, 900);
}

TEST(WindowEvents, AKeyCountsWithTheModifiersItWasStruckWith) {
    WindowEvents events;  // Ctrl+Z, Ctrl+Shift+Z, then Z alone, all within a frame
    events.key(GLFW_KEY_LEFT_CONTROL, true);
    events.key(GLFW_KEY_Z, true);
    events.key(GLFW_KEY_Z, false);
    events.key(GLFW_KEY_LEFT_SHIFT, true);
    events.key(GLFW_KEY_Z, true);
    events.key(GLFW_KEY_LEFT_CONTROL, false);
    events.key(GLFW_KEY_LEFT_SHIFT, false);
    events.key(GLFW_KEY_Z, false);
    events.key(GLFW_KEY_Z, true);
    std::vector<std::pair<bool, bool>> struck;  // with Ctrl, with Shift
    bool was_down = false;
    for (int frame = 0; frame < 12; ++frame) {
        events.next_frame();
        const bool is_down = events.is_down(GLFW_KEY_Z);
        if (is_down && !was_down)
            struck.emplace_back(events.is_down(GLFW_KEY_LEFT_CONTROL), events.is_down(GLFW_KEY_LEFT_SHIFT));
        was_down = is_down;
    }
    EXPECT_EQ(struck, (std::vector<std::pair<bool, bool>>{{true, false}, {true, true}, {false, false}}));
}

TEST(WindowEvents, AKeyThatFollowsAClickDoesNotComeBeforeIt) {
    WindowEvents events;
    events.button(GLFW_MOUSE_BUTTON_LEFT, true);
    events.button(GLFW_MOUSE_BUTTON_LEFT, false);
    events.key(GLFW_KEY_ESCAPE, true);
    events.next_frame();
    events.next_frame();
    EXPECT_FALSE(events.is_button_down(GLFW_MOUSE_BUTTON_LEFT));
    EXPECT_FALSE(events.is_down(GLFW_KEY_ESCAPE)) << "it would take the click back";
    events.next_frame();
    EXPECT_TRUE(events.is_down(GLFW_KEY_ESCAPE));
}

TEST(WindowEvents, AreNeverFarBehindAndEndAsTheHandsDo) {
    WindowEvents events;
    std::mt19937 random{7};
    bool keys[GLFW_KEY_LAST + 1] = {};
    for (int frame = 0; frame < 200; ++frame) {
        for (auto i = random() % 60; i > 0; --i) {
            const int key =
                random() % 2 == 0 ? GLFW_KEY_LEFT_SHIFT : GLFW_KEY_A + static_cast<int>(random() % 5);
            events.key(key, keys[key] = !keys[key]);
        }
        events.next_frame();
    }
    int frames = 0;  // nothing more happens
    const auto is_behind = [&] {
        for (int key = 0; key <= GLFW_KEY_LAST; ++key)
            if (events.is_down(key) != keys[key]) return true;
        return false;
    };
    for (; is_behind(); ++frames) {
        ASSERT_LT(frames, 300);
        events.next_frame();
    }
    for (int i = 0; i < 300; ++i) events.next_frame();
    EXPECT_FALSE(is_behind());
}

TEST(WindowEvents, OfKeysAndButtonsThatNobodyKnowsAreDropped) {
    WindowEvents events;
    for (const int unknown : {-1, -1000, 512, 1 << 30}) {
        events.key(unknown, true);
        events.button(unknown, true);
    }
    events.next_frame();
    for (const int unknown : {-1, -1000, 512, 1 << 30}) {
        EXPECT_FALSE(events.is_down(unknown));
        EXPECT_FALSE(events.is_button_down(unknown));
    }
}

}  // namespace
}  // namespace tessera
