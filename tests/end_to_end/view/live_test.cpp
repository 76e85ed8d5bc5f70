// tessera-view over the stream: what it shows while others edit.
#include <chrono>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>

#include "client/link/background_stream_client.h"
#include "client/view/headless_run.h"
#include "shared/wire/json.h"
#include "tests/end_to_end/live_edit/live_scene.h"
#include "tests/end_to_end/view/program.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Straight down on sprite 1's place, for a few seconds.
class LiveView : public ::testing::Test {
  protected:
    void SetUp() override {
        server = std::make_unique<test::Program>(scene.arguments());
        port = server->port();
        std::ofstream{scene.file("path.json")} << R"({"keys": [
            {"time": 0, "x": 100, "y": 100, "height": 150, "yaw": 0, "pitch": -80},
            {"time": 9, "x": 100, "y": 100, "height": 150, "yaw": 0, "pitch": -80}]})";
    }
    std::vector<std::string> words(const std::string& out, std::vector<std::string> more) const {
        std::vector<std::string> all{"http://127.0.0.1:" + std::to_string(port),
                                     "sprites",
                                     "--headless",
                                     "--size",
                                     "320x280",
                                     "--camera",
                                     scene.file("path.json").string(),
                                     "-o",
                                     scene.file(out).string()};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    view::RunMetrics metrics(const std::string& out) const {
        std::ostringstream text;
        text << std::ifstream{scene.file(out) / "metrics.json"}.rdbuf();
        view::RunMetrics read;
        EXPECT_TRUE(read_json(text.str(), "metrics.json", read));
        return read;
    }
    void place_sprite() const {
        BackgroundStreamClient editor{{"127.0.0.1", port}, "sprites", {}};
        proto::Edit edit;
        proto::SpritePlacement& sprite = *edit.add_changes()->mutable_place_sprite();
        sprite.set_id(1);
        sprite.set_x(100);
        sprite.set_y(100);
        sprite.set_scale(2);
        editor.edit(edit);
        std::vector<BackgroundStreamClient::Fate> fates;
        for (int i = 0; i < 1000 && fates.empty(); ++i) {
            editor.wait_for_news(milliseconds{10});
            fates = editor.take_fates();
        }
        ASSERT_EQ(fates.size(), 1u);
        EXPECT_TRUE(std::holds_alternative<proto::EditAnswer>(fates[0].fate));
    }
    std::string picture(const std::string& out, int frame) const {
        char name[32];
        std::snprintf(name, sizeof name, "frame_%04d.png", frame);
        std::ostringstream bytes;
        bytes << std::ifstream{scene.file(out) / name, std::ios::binary}.rdbuf();
        return bytes.str();
    }
    /// Flies, and does this once a frame shows what `before` shows: on a busy machine that takes a while.
    view::RunMetrics fly(const std::function<void()>& meanwhile) const {
        std::vector<std::string> command =
            words("flight", {"--free-run", "--frames", std::to_string(frames)});
        command.insert(command.begin(), VIEW_PROGRAM);
        tessera::testing::Program viewer{command};
        const std::string sharp = picture("before", 0);
        for (int i = 0, frame = 0; i < 1000 && frame < frames; ++i) {
            if (picture("flight", frame) == sharp) break;
            if (!picture("flight", frame + 1).empty()) ++frame;
            std::this_thread::sleep_for(milliseconds{10});
        }
        meanwhile();
        const auto ended = viewer.end();
        EXPECT_EQ(ended.exit_code, 0) << ended.error;
        return metrics("flight");
    }

    static constexpr int frames = 72;
    test::LiveScene scene;
    std::unique_ptr<test::Program> server;
    std::uint16_t port = 0;
};

TEST_F(LiveView, ShowsAnEditThatWasMadeMeanwhile) {
    ASSERT_EQ(tessera::testing::run_view(words("before", {})).exit_code, 0);
    const view::RunMetrics flight = fly([&] { place_sprite(); });
    ASSERT_EQ(tessera::testing::run_view(words("after", {"--http"})).exit_code, 0);
    const view::RunMetrics after = metrics("after");
    EXPECT_NE(metrics("before").frames(0).hash(), after.frames(0).hash());
    EXPECT_EQ(flight.frames(frames - 1).hash(), after.frames(0).hash())
        << "as who comes later sees it, by HTTP";
}

TEST_F(LiveView, GoesOnAfterTheServerCameBackAndAsksOnlyForWhatChanged) {
    ASSERT_EQ(tessera::testing::run_view(words("before", {})).exit_code, 0);
    const view::RunMetrics flight = fly([&] {
        server.reset();  // by SIGKILL
        server = std::make_unique<test::Program>(scene.arguments(port));
        ASSERT_EQ(server->port(), port);
        place_sprite();
    });
    ASSERT_EQ(tessera::testing::run_view(words("after", {})).exit_code, 0);
    const view::RunMetrics before = metrics("before"), after = metrics("after");
    EXPECT_THAT(flight.frames(),
                ::testing::Contains(::testing::Property(&view::FrameMetrics::hash, before.frames(0).hash())));
    EXPECT_EQ(flight.frames(frames - 1).hash(), after.frames(0).hash());
    // The sprite lies on a few pages of each of the seven levels
    std::cout << flight.totals().requests() << " requests; one picture takes " << before.totals().requests()
              << "\n";
    EXPECT_LE(flight.totals().requests(), before.totals().requests() + 16);
}

}  // namespace
}  // namespace tessera
