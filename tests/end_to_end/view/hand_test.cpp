// Hands over a real server: what they hold looks as the pages will, and gives way to them in one frame.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "client/render/gl_context.h"
#include "client/view/frame_painter.h"
#include "client/view/hand_desk.h"
#include "client/view/hand_view.h"
#include "client/view/stream_page_source.h"
#include "tests/end_to_end/live_edit/live_scene.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;

constexpr int side = 320;
constexpr std::int32_t pattern_side = 32;
constexpr std::int64_t middle = 4096;

/// A scene whose first pattern is a leaf with a soft edge, over one colour; three more, in other colours, are
/// the frames of its animation, each for three steps.
struct LeafScene : test::LiveScene {
    LeafScene() {
        std::vector<std::uint8_t> texels;
        for (int y = 0; y < 4 * pattern_side; ++y)
            for (int x = 0; x < pattern_side; ++x) {
                const int frame = y / pattern_side;
                const double u = (x + 0.5) / pattern_side * 2 - 1,
                             v = (y % pattern_side + 0.5) / pattern_side * 2 - 1;
                const double inside = 1 - std::hypot(u * 1.5, v);
                texels.push_back(static_cast<std::uint8_t>(frame == 2 ? 20 : 120 + 100 * u));
                texels.push_back(static_cast<std::uint8_t>(frame == 3 ? 20 : 140 + 80 * v));
                texels.push_back(static_cast<std::uint8_t>(std::abs(u) < 0.1 ? 220 : 60));
                texels.push_back(static_cast<std::uint8_t>(255 * std::clamp(inside * 4, 0.0, 1.0)));
            }
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = pattern_side;
        image.height = 4 * pattern_side;
        image.format = PNG_FORMAT_RGBA;
        const std::filesystem::path folder = file("sprites");
        png_image_write_to_file(&image, (folder / "patterns.png").c_str(), 0, texels.data(), 0, nullptr);
        std::ofstream{folder / "scene.json"}
            << R"({"constant": {"color": {"red": 90, "green": 110, "blue": 140}}, "extent_log2_pages": 6,
                   "sprites": {"patterns": {"image": "patterns.png", "side_texels": 32}, "animations": [{"frames":
                       [{"pattern": 1, "steps": 3}, {"pattern": 2, "steps": 3}, {"pattern": 3, "steps": 3}]}]}})";
    }
};

struct Difference {
    int most = 0;
    double mean = 0;
};

/// Of a square of pixels around a point.
Difference difference(const Rgba8Image& a, const Rgba8Image& b, int x = side / 2, int y = side / 2,
                      int reach = side / 2) {
    Difference found;
    for (int row = std::max(0, y - reach); row < std::min(side, y + reach); ++row)
        for (int i = 4 * std::max(0, x - reach); i < 4 * std::min(side, x + reach); ++i) {
            const int one = std::abs(int{a.row(row)[i]} - int{b.row(row)[i]});
            found.most = std::max(found.most, one);
            found.mean += one;
        }
    found.mean /= 16.0 * reach * reach;
    return found;
}

class HandOverServer : public ::testing::Test {
  protected:
    HandOverServer() : server{scene.arguments()}, address{"127.0.0.1", server.port()} {
        auto made = make_headless_context();
        if (!made) throw std::runtime_error{made.error().detail};
        context = std::move(*made);
        auto read = read_scene_info(address, "sprites");
        if (!read) throw std::runtime_error{read.error().detail};
        info = *read;
        target.emplace(side, side);
        source = std::make_unique<StreamPageSource>(address, info, ChannelSet::albedo, "Ada");
        plane = std::move(PlaneScene::make(info.extent, *source, {}).value());
        painter = std::make_unique<FramePainter>(*plane);
        desk = std::make_unique<HandDesk>(*source->stream(), address, info, "Ada");
        desk->is_open = true;
    }

    /// The next frame's picture.
    const Rgba8Image& frame() {
        now += ClientTime{16};
        ViewFrame shown{.camera = camera,
                        .width = side,
                        .height = side,
                        .time = {now, step},
                        .filter = filter,
                        .surface = surface};
        const PlaneView view = shown.view();
        desk->advance({.now = now,
                       .step = step,
                       .texels_per_pixel = HandPicture{view}.texels_per_pixel(side / 2, side / 2),
                       .view = {middle - 1000, middle - 1000, middle + 1000, middle + 1000}});
        desk->fill(shown);
        for (const std::int32_t pattern : desk->take_new_pictures())
            plane->held_patterns().set_pattern(pattern, *desk->picture(pattern), desk->pattern_side_texels());
        if (wants_first_picture) desk->want_picture(0);
        shown_holds = shown.holds;
        outcome = painter->update(shown);
        if (const auto drawn = painter->draw(shown, *target); !drawn)
            throw std::runtime_error{drawn.error().detail};
        desk->drawn(outcome);
        return picture = target->read();
    }
    template <class Done>
    bool until(Done done) {
        for (int i = 0; i < 1500; ++i) {
            frame();
            if (done()) return true;
            source->wait(milliseconds{10});
        }
        return false;
    }
    bool is_quiet() const {
        return desk->edits().waiting() == 0 && desk->hand().carries().empty() && outcome.is_current() &&
               outcome.is_sharp();
    }
    /// Whether every page that is seen and has the sprite is shown without it.
    bool is_lifted() const {
        const Residency& residency = plane->residency();
        const auto holds = desk->hand().carries().holds();
        if (holds.empty() || !outcome.is_sharp()) return false;
        return std::ranges::all_of(outcome.sampled, [&](const NeededPage& page) {
            const auto shown = residency.table().shown_for(page.key);
            return !meets_any(box_of_page(page.key), holds.back().lifted_boxes) ||
                   (shown && shown->slot >= residency.cache().capacity());
        });
    }
    void begin() {
        ASSERT_TRUE(until([&] { return desk->may_edit() && desk->picture(0) && is_quiet(); }));
    }
    HandPoint at(double x, double y) const {
        return {middle * sprite_units + static_cast<std::int64_t>(x * sprite_units),
                middle * sprite_units + static_cast<std::int64_t>(y * sprite_units)};
    }
    void place(double x, double y) {
        Hand& hand = desk->hand();
        hand.choose(0);
        hand.press(at(x, y), false);
        hand.release(at(x, y), false);
        hand.choose(std::nullopt);
        hand.hover(std::nullopt);
    }
    void look_down(double texels_per_pixel) {
        camera = {.ground = {middle, middle}, .pitch_degrees = -90};
        camera.height_texels =
            texels_per_pixel * side / 2 / std::tan(camera.field_of_view_degrees * 3.14159265 / 360);
    }
    /// Frames from now on until the pages show all: the worst that any differs from the first.
    Difference worst_until_quiet(const Rgba8Image& first) {
        Difference worst;
        EXPECT_TRUE(until([&] {
            const Difference now_differs = difference(first, picture);
            worst.most = std::max(worst.most, now_differs.most);
            worst.mean = std::max(worst.mean, now_differs.mean);
            return is_quiet();
        }));
        return worst;
    }

    LeafScene scene;
    test::Program server;
    ServerAddress address;
    std::unique_ptr<GlContext> context;
    SceneInfo info;
    std::unique_ptr<StreamPageSource> source;
    std::unique_ptr<PlaneScene> plane;
    std::unique_ptr<FramePainter> painter;
    std::unique_ptr<HandDesk> desk;
    std::optional<FrameTarget> target;
    Camera camera;
    Surface surface{};
    FilterChoice filter{};
    ResidencyFrame outcome;
    std::vector<PageHold> shown_holds;
    bool wants_first_picture = true;
    Rgba8Image picture;
    ClientTime now{};
    Step step = 0;
};

TEST_F(HandOverServer, WhatIsHeldLooksAsThePagesWillAtEveryLevelScaleAndTurn) {
    look_down(1);
    begin();
    place(0.3, 0.7);
    ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 1; }));
    Hand& hand = desk->hand();
    hand.select_all();
    ASSERT_EQ(hand.selected().size(), 1u);
    // Codes of 255; where a footprint takes many probes these read the pattern's own MIP levels
    struct Case {
        double texels_per_pixel, scale, turns;
        FilterChoice filter{};
        double pitch = -90;
        int most = 4;
    };
    const FilterChoice anisotropic{Filter::anisotropic}, supersample{Filter::supersample, 2};
    for (const Case& one :
         {Case{0.3, 1.5, 0}, Case{0.3, 2.3, 0.13}, Case{1, 1, 0.25}, Case{1, 3.1, 0.07}, Case{2.7, 4, 0.41},
          Case{6, 4, 0.3}, Case{1.4, 3, 0.2, {Filter::bilinear}}, Case{2, 3, 0.6, {Filter::nearest}},
          Case{0.5, 1, 0.37, anisotropic}, Case{1.2, 3.5, 0.8, anisotropic, -35, 12},
          Case{1.2, 3, 0.1, supersample, -60, 12}}) {
        filter = one.filter;
        look_down(one.texels_per_pixel);
        camera.pitch_degrees = one.pitch;
        if (one.pitch > -90)
            camera.ground.y +=
                static_cast<std::int64_t>(camera.height_texels / std::tan(-one.pitch * 3.14159265 / 180));
        ASSERT_TRUE(until([&] { return is_quiet(); }));
        const Rgba8Image before = picture;
        hand.preview_scale(one.scale);
        hand.preview_turns(one.turns);
        // Lifted from the pages, and in the hand alone
        ASSERT_TRUE(until([&] { return is_lifted(); }));
        const Rgba8Image held = frame();
        EXPECT_GT(difference(before, held).most, 20) << "it has changed";
        hand.put_preview();
        const Difference worst = worst_until_quiet(held);
        std::cout << name_of(filter.filter) << ", " << one.texels_per_pixel << " texels a pixel, scale "
                  << one.scale << ", turn " << one.turns << ": at most " << worst.most << " codes, "
                  << worst.mean << " on average\n";
        EXPECT_LE(worst.most, one.most);
        EXPECT_LE(worst.mean, 0.2);
    }
}

TEST_F(HandOverServer, ADragShowsTheSpriteOnceInEveryFrameAndUndoBringsThePictureBack) {
    look_down(1);
    begin();
    const Rgba8Image empty = picture;
    place(-60, 0);
    ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 1; }));
    const Rgba8Image placed = picture;
    constexpr int old_x = side / 2 - 60, new_x = side / 2 + 70, reach = 30;
    ASSERT_GT(difference(empty, placed, old_x, side / 2, reach).most, 50);

    Hand& hand = desk->hand();
    ASSERT_TRUE(hand.press(at(-60, 2), false));
    // The page without it comes; it stays where it is, in the hand
    ASSERT_TRUE(until([&] {
        EXPECT_LE(difference(placed, picture, old_x, side / 2, reach).most, 60);
        return is_lifted();
    }));
    hand.drag(at(70, 2), true, false);
    const Rgba8Image dragged = frame();
    EXPECT_LE(difference(empty, dragged, old_x, side / 2, reach).most, 1) << "not where it was";
    EXPECT_GT(difference(empty, dragged, new_x, side / 2, reach).most, 50) << "in the same frame";

    hand.release(at(70, 2), true);
    int frames = 0;
    ASSERT_TRUE(until([&] {
        ++frames;
        EXPECT_LE(difference(empty, picture, old_x, side / 2, reach).most, 1) << "never in both places";
        EXPECT_LE(difference(dragged, picture, new_x, side / 2, reach).most, 8) << "never in none";
        return is_quiet();
    }));
    EXPECT_GT(frames, 1);
    EXPECT_TRUE(outcome.ended_holds.empty() || desk->hand().held().empty());

    desk->undo();
    ASSERT_TRUE(until([&] { return is_quiet(); }));
    EXPECT_EQ(difference(placed, picture).most, 0) << "the same pages, byte for byte";
    desk->redo();
    ASSERT_TRUE(until([&] { return is_quiet(); }));
    EXPECT_LE(difference(dragged, picture, new_x, side / 2, reach).most, 8);
}

TEST_F(HandOverServer, OnHillsAndInACorridorTheHandTakesWhatItsPixelShowsAndPutsItWhereItPoints) {
    struct Case {
        Surface::Kind kind;
        double pitch;
        int from_x, from_y, to_x, to_y;
    };
    for (const Case& one : {Case{Surface::Kind::terrain, -25, 110, 230, 215, 220},
                            Case{Surface::Kind::corridor, -5, 100, 250, 292, 190}}) {  // floor to wall
        SCOPED_TRACE(name_of(one.kind));
        camera = {
            .ground = {middle, middle}, .height_texels = 90, .yaw_degrees = 12, .pitch_degrees = one.pitch};
        surface = around({.kind = one.kind, .relief = 2}, camera);
        ASSERT_NO_FATAL_FAILURE(begin());
        const Rgba8Image empty = picture;
        const PlaneView view{camera, side, side, surface};
        const HandPicture seen{view};
        const auto from = seen.point_at(one.from_x, one.from_y, info.extent),
                   to = seen.point_at(one.to_x, one.to_y, info.extent);
        ASSERT_TRUE(from && to);
        constexpr int reach = 14;
        const auto differ = [&](const Rgba8Image& a, const Rgba8Image& b, bool at_new) {
            return difference(a, b, at_new ? one.to_x : one.from_x, at_new ? one.to_y : one.from_y, reach)
                .most;
        };
        Hand& hand = desk->hand();
        hand.choose(0);
        hand.press(*from, false);
        hand.release(*from, false);
        hand.choose(std::nullopt);
        ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 1; }));
        const Rgba8Image placed = picture;
        EXPECT_GT(differ(empty, placed, false), 50) << "where it was pointed at";

        ASSERT_TRUE(hand.press(*from, false)) << "and it can be taken there";
        ASSERT_TRUE(until([&] { return is_lifted(); }));
        hand.drag(*to, true, false);
        const Rgba8Image dragged = frame();
        EXPECT_LE(differ(empty, dragged, false), 1) << "not where it was";
        EXPECT_GT(differ(empty, dragged, true), 50) << "in the same frame";
        hand.release(*to, true);
        ASSERT_TRUE(until([&] {
            EXPECT_LE(differ(empty, picture, false), 1) << "never in both places";
            EXPECT_LE(differ(dragged, picture, true), 12) << "never in none";
            return is_quiet();
        }));
        desk->undo();
        ASSERT_TRUE(until([&] { return is_quiet(); }));
        EXPECT_EQ(difference(placed, picture).most, 0) << "the same pages, byte for byte";
        desk->undo();
        ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 0; }));
        EXPECT_EQ(difference(empty, picture).most, 0);
    }
}

TEST_F(HandOverServer, OnHillsAndInACorridorWhatIsHeldLooksAsThePages) {
    look_down(1);
    ASSERT_NO_FATAL_FAILURE(begin());
    std::mt19937 random{5};
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    int tried = 0;
    for (int i = 0; tried < 14 && i < 60; ++i) {
        camera = {.ground = {middle, middle},
                  .height_texels = uniform(40, 300),
                  .yaw_degrees = uniform(0, 360),
                  .pitch_degrees = uniform(-30, -4)};
        const bool is_hills = i % 4 != 3;
        surface = around(
            {.kind = is_hills ? Surface::Kind::terrain : Surface::Kind::corridor, .relief = uniform(0.5, 3)},
            camera);
        filter = {i % 2 == 1 ? Filter::anisotropic : Filter::trilinear};
        frame();
        const PlaneView view{camera, side, side, surface};
        const auto at = HandPicture{view}.point_at(uniform(60, 260), uniform(100, 300), info.extent);
        if (!at || std::hypot(plane_point(*at).x - middle, plane_point(*at).y - middle) > 900) continue;
        ++tried;
        Hand& hand = desk->hand();
        hand.choose(0);
        hand.press(*at, false);
        hand.release(*at, false);
        hand.choose(std::nullopt);
        ASSERT_TRUE(until([&] { return is_quiet() && hand.book().size() == 1; }));
        hand.select_all();
        hand.preview_scale(uniform(1, 4));
        hand.put_preview();
        ASSERT_TRUE(until([&] { return is_quiet(); }));
        const Rgba8Image placed = picture;
        // Lifted, and held where it is
        ASSERT_TRUE(hand.press(*at, false));
        hand.drag(*at, true, false);
        ASSERT_TRUE(until([&] { return is_lifted(); }));
        const Difference held = difference(placed, frame());
        EXPECT_LE(held.most, filter.filter == Filter::trilinear ? 4 : 16) << "view " << i;
        EXPECT_LE(held.mean, 0.2);
        hand.cancel();
        hand.select_all();
        hand.remove();
        ASSERT_TRUE(until([&] { return is_quiet() && hand.book().size() == 0; }));
        EXPECT_GT(difference(placed, picture).most, 40) << "it was seen";
    }
    EXPECT_EQ(tried, 14);
}

TEST_F(HandOverServer, AnAnimatedSpriteInTheHandShowsTheFrameOfTheStepAndIsPutDownWithIt) {
    look_down(1);
    begin();
    proto::Change placed;
    auto& sprite = *placed.mutable_place_sprite();
    sprite.set_id(77);
    sprite.set_x(middle + 0.5);
    sprite.set_y(middle);
    sprite.set_scale(2.5);
    sprite.set_turn(0.1);
    sprite.set_animation(0);
    sprite.set_phase(1);
    desk->edits().make({placed});
    ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 1; }));

    Hand& hand = desk->hand();
    double x = 0;
    std::vector<Rgba8Image> by_frame;
    for (const Step at_step : {Step{0}, Step{2}, Step{5}, Step{-1}}) {  // frames 0, 1, 2, 0 with its phase
        step = at_step;
        ASSERT_TRUE(until([&] { return is_quiet(); }));
        ASSERT_TRUE(hand.press(at(x, 0), false)) << "what it covers is what it shows";
        hand.drag(at(x + 20, 0), true, false);
        ASSERT_TRUE(
            until([&] { return is_lifted() && desk->picture(1) && desk->picture(2) && desk->picture(3); }));
        const Rgba8Image held = frame();
        // Time goes on in the hand; then back
        by_frame.clear();
        for (const Step later : {0, 3, 6, 9}) {
            step = at_step + later;
            ASSERT_TRUE(until([&] { return is_lifted(); }));
            by_frame.push_back(frame());
        }
        EXPECT_GT(difference(by_frame[0], by_frame[1]).most, 20);
        EXPECT_GT(difference(by_frame[1], by_frame[2]).most, 20);
        EXPECT_GT(difference(by_frame[2], by_frame[0]).most, 20);
        EXPECT_EQ(difference(by_frame[0], by_frame[3]).most, 0) << "it begins again";
        step = at_step;
        ASSERT_TRUE(until([&] { return is_lifted(); }));
        EXPECT_EQ(difference(held, frame()).most, 0);
        hand.release(at(x + 20, 0), true);
        const Difference worst = worst_until_quiet(held);
        std::cout << "step " << step << ": at most " << worst.most << " codes, " << worst.mean
                  << " on average\n";
        EXPECT_LE(worst.most, 4);
        EXPECT_LE(worst.mean, 0.2);
        x += 20;
    }
}

TEST_F(HandOverServer, ASpriteWhosePictureHasNotComeStaysOnItsPages) {
    look_down(1);
    wants_first_picture = false;
    ASSERT_TRUE(until([&] { return desk->may_edit() && is_quiet(); }));
    const Rgba8Image empty = picture;
    proto::Change placed;
    auto& sprite = *placed.mutable_place_sprite();
    sprite.set_id(5);
    sprite.set_x(middle - 60);
    sprite.set_y(middle);
    sprite.set_pattern(0);
    desk->edits().make({placed});
    ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 1; }));
    const Rgba8Image before = picture;
    constexpr int old_x = side / 2 - 60, new_x = side / 2 + 70, reach = 30;
    ASSERT_GT(difference(empty, before, old_x, side / 2, reach).most, 50);

    Hand& hand = desk->hand();
    ASSERT_TRUE(hand.press(at(-60, 0), false));
    hand.drag(at(70, 0), true, false);
    int without = 0;
    ASSERT_TRUE(until([&] {
        const bool has_picture = desk->picture(0) != nullptr;
        EXPECT_EQ(shown_holds.at(0).lifted.empty(), !has_picture);
        without += has_picture ? 0 : 1;
        const bool is_old = difference(empty, picture, old_x, side / 2, reach).most > 50,
                   is_new = difference(empty, picture, new_x, side / 2, reach).most > 50;
        EXPECT_TRUE(is_old || is_new) << "in no frame nowhere";
        EXPECT_FALSE(is_new && !has_picture);
        return is_lifted() && is_new && !is_old;
    }));
    EXPECT_GT(without, 0) << "the picture was there from the first";
}

TEST_F(HandOverServer, WhatTheServerRefusesGoesBackAndIsSaid) {
    look_down(1);
    begin();
    place(0, 0);
    ASSERT_TRUE(until([&] { return is_quiet() && desk->hand().book().size() == 1; }));
    const Rgba8Image placed = picture;
    // Somebody else takes it away while it is in the hand
    Hand& hand = desk->hand();
    ASSERT_TRUE(hand.press(at(0, 0), false));
    hand.drag(at(40, 40), true, false);
    BackgroundStreamClient other{address, "sprites", {}};
    proto::Edit edit;
    edit.add_changes()->mutable_remove_sprite()->set_id(hand.selected().front());
    other.edit(edit);
    ASSERT_TRUE(until([&] { return desk->hand().book().size() == 0; }));
    hand.release(at(40, 40), true);
    ASSERT_TRUE(until([&] { return !desk->message().empty(); }));
    ASSERT_TRUE(until([&] { return is_quiet(); }));
    EXPECT_GT(difference(placed, picture).most, 50) << "it is gone";
    EXPECT_TRUE(hand.held().empty());
    EXPECT_TRUE(hand.selected().empty());
}

}  // namespace
}  // namespace tessera
