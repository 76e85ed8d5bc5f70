// Everything that hands do to a scene, done in a real window; the server says what came of it.
#include <algorithm>
#include <cmath>

#include <X11/keysym.h>
#include <gmock/gmock.h>

#include "proto/editables.pb.h"
#include "proto/sprite.pb.h"

#include "tests/end_to_end/window/window_program.h"

namespace tessera::test {
namespace {

constexpr std::uint32_t palette_colour = 0x68707b, button_colour = 0x2b333e, chosen_colour = 0x5c451f,
                        slider_colour = 0x29303b;
constexpr double near_enough = 0.3;  ///< Texels: a pixel, and what hands round

class EditingWindow : public WindowOnMeadow {
  protected:
    void begin(const std::vector<std::string>& more = {}) {
        ASSERT_NO_FATAL_FAILURE(open(more));
        screen->tap(XK_Tab);
        screen->tap(XK_Return);
        ASSERT_TRUE(until([&] { return runs_of(palette_colour, 30).size() == 4; })) << "a palette of four";
    }
    std::size_t count() const { return static_cast<std::size_t>(sprites().sprites_size()); }
    proto::SpritePlacement sprite() const { return sprites().sprites(0); }
    bool is_one_at(double x, double y) const {
        const proto::SpriteList all = sprites();
        return std::ranges::any_of(all.sprites(), [&](const proto::SpritePlacement& placed) {
            return std::abs(placed.x() - x) < near_enough && std::abs(placed.y() - y) < near_enough;
        });
    }
    /// The frame around one sprite, as the window draws it.
    SelectionFrame frame_of(const proto::SpritePlacement& placed) const {
        const HandSprite one = hand_sprite_of(placed, 4, 8).value();
        return *SelectionFrame::around(std::span{&one, 1}, 0.25);
    }
    void place(char key, double x, double y) {
        screen->tap(static_cast<xcb_keysym_t>(key));
        click(x, y);
        screen->tap(XK_Escape);
    }
    /// One of "Hand", "Brush", "Targets", from the left.
    void choose_tool(std::size_t which) {
        const auto chosen = runs_of(chosen_colour, 6);
        ASSERT_FALSE(chosen.empty());
        const XScreen::Picture picture = screen->picture();
        const int y = static_cast<int>(chosen.front().y);
        std::vector<double> buttons;  // all in the chosen one's row
        for (int x = 0, begin = 0; x < picture.width; ++x) {
            const auto is_button = [&](int at) {
                return at < picture.width &&
                       (picture.at(at, y) == button_colour || picture.at(at, y) == chosen_colour);
            };
            if (!is_button(x)) begin = x + 1;
            if (is_button(x) && !is_button(x + 1) && x - begin > 10) buttons.push_back((begin + x) / 2.0);
        }
        ASSERT_GT(buttons.size(), which);
        screen->click(buttons[which], y - 4);
        let_frames_pass();
    }
};

TEST_F(EditingWindow, PlacesMovesScalesTurnsCopiesAndRemovesSprites) {
    ASSERT_NO_FATAL_FAILURE(begin());
    const auto palette = runs_of(palette_colour, 30);
    screen->click(palette[1].x, palette[1].y - 12);
    click(700, 700);
    ASSERT_TRUE(until([&] { return count() == 1; })) << "clicked in the palette and on the plane";
    EXPECT_TRUE(is_one_at(700, 700));
    EXPECT_EQ(sprite().pattern(), 1u);
    screen->tap(XK_Escape);
    let_frames_pass();

    drag(700, 700, 730, 690);
    ASSERT_TRUE(until([&] { return is_one_at(730, 690); })) << "dragged";
    let_frames_pass();

    const HandOffset corner = frame_of(sprite()).corners[2];
    drag(730 + corner.x, 690 + corner.y, 730 + 2 * corner.x, 690 + 2 * corner.y);
    ASSERT_TRUE(until([&] { return std::abs(sprite().scale() - 2) < 0.1; })) << "scaled by a corner";
    EXPECT_TRUE(is_one_at(730, 690));
    let_frames_pass();

    const HandOffset knob = frame_of(sprite()).knob;
    screen->hold(XK_Shift_L);
    drag(730 + knob.x, 690 + knob.y, 730 - knob.y, 690 + knob.x);
    screen->let_go(XK_Shift_L);
    ASSERT_TRUE(until([&] { return std::abs(sprite().turn() - 0.25) < 1e-4; })) << "turned by the knob";
    let_frames_pass();

    screen->tap('d', {XK_Control_L});
    ASSERT_TRUE(until([&] { return count() == 2; })) << "copied";
    let_frames_pass();
    screen->tap(XK_Delete);
    ASSERT_TRUE(until([&] { return count() == 1; })) << "removed";
    let_frames_pass();
    screen->tap('z', {XK_Control_L});
    ASSERT_TRUE(until([&] { return count() == 2; })) << "undone";
    let_frames_pass();
    screen->tap('z', {XK_Control_L, XK_Shift_L});
    ASSERT_TRUE(until([&] { return count() == 1; })) << "redone";
}

TEST_F(EditingWindow, TakesSeveralSpritesTogether) {
    ASSERT_NO_FATAL_FAILURE(begin());
    place('1', 700, 700);
    ASSERT_TRUE(until([&] { return count() == 1; }));
    place('3', 740, 700);
    ASSERT_TRUE(until([&] { return count() == 2; }));
    let_frames_pass();
    const std::uint64_t before = revision();
    click(700, 700);
    screen->hold(XK_Shift_L);
    click(740, 700);
    screen->let_go(XK_Shift_L);
    drag(740, 700, 750, 720);
    ASSERT_TRUE(until([&] { return is_one_at(710, 720) && is_one_at(750, 720); }));
    EXPECT_EQ(revision(), before + 1) << "one gesture, one edit";
    let_frames_pass();

    screen->tap(XK_Escape);
    screen->hold(XK_Shift_L);
    drag(690, 700, 770, 735);  // a frame around both
    screen->let_go(XK_Shift_L);
    let_frames_pass();                    // GLFW takes Shift twice in a millisecond for once
    screen->tap(XK_Right, {XK_Shift_L});  // ten texels
    ASSERT_TRUE(until([&] { return is_one_at(720, 720) && is_one_at(760, 720); }));
    let_frames_pass();
    screen->tap(XK_BackSpace);
    ASSERT_TRUE(until([&] { return count() == 0; }));
    let_frames_pass();
    screen->tap('z', {XK_Control_L});
    EXPECT_TRUE(until([&] { return count() == 2; }));
}

TEST_F(EditingWindow, EditsOnHillsAndInACorridorAndASessionOfItIsDrawnAgain) {
    for (const auto kind : {Surface::Kind::terrain, Surface::Kind::corridor}) {
        SCOPED_TRACE(name_of(kind));
        surface.kind = kind;
        const std::string session = (files.path / "session").string();
        ASSERT_NO_FATAL_FAILURE(begin({"--record", session, "--record-hashes"}));
        place('1', 700, 700);
        ASSERT_TRUE(until([&] { return is_one_at(700, 700); })) << "placed";
        let_frames_pass();
        drag(700, 700, 740, 690);
        ASSERT_TRUE(until([&] { return is_one_at(740, 690); })) << "dragged";
        let_frames_pass();
        const HandOffset corner = frame_of(sprite()).corners[2];
        drag(740 + corner.x, 690 + corner.y, 740 + 2 * corner.x, 690 + 2 * corner.y);
        ASSERT_TRUE(until([&] { return std::abs(sprite().scale() - 2) < 0.1; })) << "scaled by a corner";
        let_frames_pass();
        screen->tap(XK_Delete);
        ASSERT_TRUE(until([&] { return count() == 0; })) << "removed";
        let_frames_pass();
        ASSERT_NO_FATAL_FAILURE(choose_tool(1));
        const std::string before = page();
        drag(690, 690, 750, 720);
        ASSERT_TRUE(until([&] { return page() != before; })) << "painted";
        let_frames_pass();
        screen->tap('z', {XK_Control_L});
        ASSERT_TRUE(until([&] { return page() == before; })) << "undone";
        let_frames_pass();
        for (int i = 0; i < 2; ++i) {  // the tool, the editor
            screen->tap(XK_Escape);
            let_frames_pass();
        }
        screen->tap(XK_Escape);
        ASSERT_EQ(viewer->end().exit_code, 0);
        testing::Program replay{
            {VIEW_PROGRAM, "--replay", session, "--headless", "-o", (files.path / "again").string()}};
        const auto ended = replay.end();
        EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.error;
        EXPECT_THAT(ended.out, ::testing::HasSubstr("hashes equal"));
    }
}

TEST_F(EditingWindow, PaintsAMapAndUndoesTheStrokeAsOne) {
    ASSERT_NO_FATAL_FAILURE(begin());
    const std::string before = page();
    ASSERT_NO_FATAL_FAILURE(choose_tool(1));
    // Until the panel is another; what is painted is the map that comes first
    drag(650, 690, 790, 740);
    ASSERT_TRUE(until([&] { return revision() > 0; }));
    const std::string painted = page();
    EXPECT_NE(painted, before);
    let_frames_pass();
    screen->tap(XK_Escape);  // to the hand
    screen->tap('z', {XK_Control_L});
    EXPECT_TRUE(until([&] { return page() == before; }));
}

TEST_F(EditingWindow, DragsATargetAndSlidesADensity) {
    ASSERT_NO_FATAL_FAILURE(begin());
    const auto sliders = runs_of(slider_colour, 60);
    ASSERT_FALSE(sliders.empty());
    screen->drag(sliders.back().x, sliders.back().y - 3, sliders.back().x + 60, sliders.back().y - 3);
    ASSERT_TRUE(until([&] { return editables().animations(0).density() > 1.01; })) << "it was 1";
    let_frames_pass();

    ASSERT_NO_FATAL_FAILURE(choose_tool(2));
    drag(750, 740, 690, 700);
    const auto is_there = [&] {
        const proto::Target target = editables().targets(0);
        return std::abs(static_cast<double>(target.x()) - 690) <= 1 &&
               std::abs(static_cast<double>(target.y()) - 700) <= 1;
    };
    EXPECT_TRUE(until(is_there)) << editables().targets(0).ShortDebugString();
}

TEST_F(EditingWindow, AToolThatIsChangedWhileTheButtonIsDownLetsGo) {
    ASSERT_NO_FATAL_FAILURE(begin());
    ASSERT_NO_FATAL_FAILURE(choose_tool(1));
    const Pixel from = pixel_of(680, 700), to = pixel_of(760, 700);
    screen->move(from.x, from.y);
    screen->press();
    let_frames_pass();
    screen->tap('v');  // back to the hand, in the middle of a stroke
    let_frames_pass();
    screen->move(to.x, to.y);
    let_frames_pass();
    screen->release();
    ASSERT_TRUE(until([&] { return revision() > 0; }));
    let_frames_pass();
    const std::uint64_t painted = revision();
    screen->move(to.x, to.y + 60);
    let_frames_pass();
    EXPECT_EQ(revision(), painted) << "no brush is down any more";
    place('1', 700, 700);
    EXPECT_TRUE(until([&] { return count() == 1; })) << "and the hand works";
}

}  // namespace
}  // namespace tessera::test
