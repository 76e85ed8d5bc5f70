// A session against a real server, with edits, is recorded and drawn again without it.
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>

#include "client/link/background_stream_client.h"
#include "client/view/view.pb.h"
#include "shared/wire/json.h"
#include "tests/end_to_end/live_edit/live_scene.h"
#include "tests/end_to_end/view/program.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::HasSubstr;

void place_sprite(std::uint16_t port, std::uint64_t id, double at) {
    BackgroundStreamClient editor{{"127.0.0.1", port}, "sprites", {}};
    proto::Edit edit;
    proto::SpritePlacement& sprite = *edit.add_changes()->mutable_place_sprite();
    sprite.set_id(id);
    sprite.set_x(at);
    sprite.set_y(100);
    sprite.set_scale(2);
    editor.edit(edit);
    std::vector<BackgroundStreamClient::Fate> fates;
    for (int i = 0; i < 1000 && fates.empty(); ++i) {
        editor.wait_for_news(milliseconds{10});
        fates = editor.take_fates();
    }
    ASSERT_EQ(fates.size(), 1u);
}

TEST(ViewRecord, ASessionWithEditsIsDrawnAgainWithEqualHashesAndNoServer) {
    const test::LiveScene scene;
    const std::string session = scene.file("flight.session").string(),
                      figures = scene.file("flight.jsonl").string();
    std::ofstream{scene.file("path.json")} << R"({"keys": [
        {"time": 0, "x": 100, "y": 100, "height": 150, "yaw": 0, "pitch": -80},
        {"time": 4, "x": 180, "y": 120, "height": 300, "yaw": 60, "pitch": -50}]})";
    {
        test::Program server{scene.arguments()};
        const std::uint16_t port = server.port();
        tessera::testing::Program viewer{
            {VIEW_PROGRAM, "http://127.0.0.1:" + std::to_string(port), "sprites", "--headless", "--size",
             "240x200", "--camera", scene.file("path.json").string(), "--free-run", "--frames", "40", "-o",
             scene.file("flight").string(), "--record", session, "--metrics", figures, "--check-pages"}};
        for (int i = 0; i < 1000 && !fs::exists(scene.file("flight") / "frame_0006.png"); ++i)
            std::this_thread::sleep_for(milliseconds{10});
        place_sprite(port, 1, 100);
        place_sprite(port, 2, 150);
        const auto ended = viewer.end();
        ASSERT_EQ(ended.exit_code, 0) << ended.error;
        EXPECT_EQ(ended.error, "");
    }
    const auto again =
        tessera::testing::run_view({"--headless", "--replay", session, "-o", scene.file("again").string()});
    EXPECT_EQ(again.exit_code, 0) << again.out << again.error;
    EXPECT_THAT(again.out,
                AllOf(HasSubstr("sprites"), HasSubstr("40 of 40 hashes equal"), HasSubstr("closed")));
    EXPECT_TRUE(fs::exists(scene.file("again") / "frame_0039.png"));

    std::ifstream lines{figures};
    view::MetricsLine line;
    int count = 0;
    for (std::string text; std::getline(lines, text); ++count) {
        line.Clear();
        ASSERT_TRUE(read_json(text, "a line", line)) << text;
        EXPECT_EQ(line.wrong_page_pixels(), 0);
    }
    EXPECT_GE(count, 4);
    EXPECT_GE(line.edits_seen(), 1u);
    EXPECT_GT(line.edit_to_visible_ms_last(), 0);
    EXPECT_GT(line.checked_pixels(), 100'000);
    EXPECT_EQ(line.revision(), 2u);

    // What is left after a crash is as good, and what it is is said
    std::ostringstream whole;
    whole << std::ifstream{session, std::ios::binary}.rdbuf();
    std::ofstream{session, std::ios::binary} << whole.str().substr(0, whole.str().size() * 2 / 3);
    const auto torn = tessera::testing::run_view({"--headless", "--replay", session});
    EXPECT_EQ(torn.exit_code, 1);
    EXPECT_THAT(torn.out, AllOf(HasSubstr("hashes equal"), HasSubstr("torn after entry")));
    std::string other = whole.str();
    other[16] = 2;
    std::ofstream{session, std::ios::binary} << other;
    const auto newer = tessera::testing::run_view({"--headless", "--replay", session});
    EXPECT_EQ(newer.exit_code, 1);
    EXPECT_THAT(newer.error, HasSubstr("version 2"));
    EXPECT_EQ(tessera::testing::run_view({"http://127.0.0.1:9", "x", "--replay", session}).exit_code, 2);
}

}  // namespace
}  // namespace tessera
