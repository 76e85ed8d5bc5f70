#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <png.h>

#include "client/link/scene_info.h"
#include "client/view/camera_path.h"
#include "client/view/view.pb.h"
#include "shared/wire/json.h"
#include "tests/end_to_end/view/page_ray_caster.h"
#include "tests/end_to_end/view/scene_server.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using namespace tessera::testing;

std::string read_text(const fs::path& file) {
    std::ifstream stream{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

Rgba8Image read_png(const fs::path& file) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&png, file.c_str()))
        throw std::runtime_error{"no PNG: " + file.string()};
    png.format = PNG_FORMAT_RGBA;
    Rgba8Image image{static_cast<std::int32_t>(png.width), static_cast<std::int32_t>(png.height)};
    png_image_finish_read(&png, nullptr, image.bytes.data(), 0, nullptr);
    return image;
}

/// A path over the far part of the widest extent, and the run's metrics.
class Headless : public ::testing::Test {
  protected:
    static void SetUpTestSuite() { server = std::make_unique<SceneServer>(); }
    static void TearDownTestSuite() { server.reset(); }

    static fs::path write_path(const std::string& keys) {
        const fs::path file = server->folder() / "path.json";
        std::ofstream{file} << "{\"keys\": [" << keys << "]}";
        return file;
    }
    static view::RunMetrics run(const std::string& scene, const std::string& keys, int frames,
                                const fs::path& out, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{server->url(),
                                           scene,
                                           "--headless",
                                           "--size",
                                           "400x350",
                                           "--frames",
                                           std::to_string(frames),
                                           "--camera",
                                           write_path(keys).string(),
                                           "-o",
                                           out.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Program::Ended ended = run_view(arguments);
        EXPECT_EQ(ended.exit_code, 0) << ended.error;
        view::RunMetrics metrics;
        const auto read = read_json(read_text(out / "metrics.json"), "metrics.json", metrics);
        EXPECT_TRUE(read) << read.error().detail;
        return metrics;
    }

    static std::unique_ptr<SceneServer> server;
};
std::unique_ptr<SceneServer> Headless::server;

constexpr const char* noise_keys =
    R"({"time": 0, "x": "137438953472", "y": "137438953000", "x_fraction": 0.5, "height": 250, "yaw": 20, "pitch": -75},
       {"time": 2, "x": "137438954472", "y": "137438953472", "height": 900, "yaw": 75, "pitch": -38})";
constexpr const char* board_keys =
    R"({"time": 0, "x": 100000000, "y": 150000000, "height": 400, "yaw": -30, "pitch": -50},
       {"time": 1, "x": 100000777, "y": 150000333, "height": 2500, "yaw": 10, "pitch": -40})";

TEST_F(Headless, FramesMatchACpuRayCastThroughTheSamePages) {
    const auto address = parse_server_address(server->url());
    ASSERT_TRUE(address);
    for (const auto& [scene, keys] : {std::pair{"noise", noise_keys}, std::pair{"board", board_keys}}) {
        const fs::path out = server->folder() / "ray_cast" / scene;
        const view::RunMetrics metrics = run(scene, keys, 3, out);
        ASSERT_EQ(metrics.frames_size(), 3);
        const auto info = read_scene_info(*address, scene);
        ASSERT_TRUE(info) << info.error().detail;
        const auto path = CameraPath::parse("{\"keys\": [" + std::string{keys} + "]}", "path", info->extent);
        ASSERT_TRUE(path) << path.error().detail;
        PageRayCaster caster{*address, *info};
        for (const view::FrameMetrics& frame : metrics.frames()) {
            const double psnr = caster.compare(read_png(out / frame.file()), path->at(frame.time()));
            std::cout << scene << " at " << frame.time() << " s: PSNR " << psnr << " dB over "
                      << caster.compared_pixels << " pixels\n";
            EXPECT_GT(psnr, 40);
            EXPECT_GT(caster.compared_pixels, 40'000u);
        }
    }
}

TEST_F(Headless, TwoRunsWriteTheSameFramesOverTheStreamAndOverHttp) {
    const view::RunMetrics first = run("noise", noise_keys, 4, server->folder() / "first");
    const view::RunMetrics second =
        run("noise", noise_keys, 4, server->folder() / "second", {"--in-flight", "3", "--http"});
    ASSERT_EQ(first.frames_size(), 4);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(first.frames(i).hash(), second.frames(i).hash()) << "frame " << i;
    EXPECT_NE(first.frames(0).hash(), first.frames(1).hash());
    EXPECT_EQ(first.totals().failed(), 0u);
    EXPECT_GT(first.totals().megabytes_received(), 0.1);
    EXPECT_THAT(first.renderer(), HasSubstr("llvmpipe"));
}

TEST_F(Headless, AConstantSceneIsOneColourWhereNoHazeLies) {
    const fs::path out = server->folder() / "grey";
    run("grey", R"({"x": 1000000, "y": 1000000, "height": 500, "pitch": -90})", 1, out);
    const Rgba8Image image = read_png(out / "frame_0000.png");
    for (std::size_t at = 0; at < image.bytes.size(); at += 4) {
        ASSERT_EQ(image.bytes[at], 90);
        ASSERT_EQ(image.bytes[at + 1], 120);
        ASSERT_EQ(image.bytes[at + 2], 150);
    }
}

TEST_F(Headless, RunsFreelyByTheClockWhereThatIsAskedFor) {
    const view::RunMetrics metrics =
        run("board", board_keys, 10, server->folder() / "free", {"--free-run", "--cache-pages", "64"});
    EXPECT_FALSE(metrics.settled());
    EXPECT_GE(metrics.totals().seconds(), 1);
    EXPECT_GT(metrics.totals().time_to_sharp_ms(), 0);
    EXPECT_LT(metrics.frames(0).resident_share(), 1);
}

}  // namespace
}  // namespace tessera
