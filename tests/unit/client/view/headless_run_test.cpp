#include "client/view/headless_run.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <gmock/gmock.h>
#include <png.h>
#include <unistd.h>

#include "client/render/gl_context.h"
#include "client/view/png_file.h"
#include "shared/wire/json.h"
#include "tests/unit/client/render/painted_pages.h"
#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::FakePageSource;

std::string noise_page(PageKey page) { return testing::paint_page(page, testing::noise_texel); }

class HeadlessRun : public ::testing::Test {
  protected:
    void SetUp() override {
        auto made = make_headless_context();
        ASSERT_TRUE(made) << made.error().detail;
        context_ = std::move(made.value());
    }
    void TearDown() override { fs::remove_all(folder); }

    Result<view::RunMetrics> run(HeadlessJob job, FakePageSource& source) {
        ResidencySettings settings;
        settings.slots = 128;
        auto scene = PlaneScene::make(extent, source, settings);
        if (!scene) return scene.error();
        auto metrics =
            run_headless(job, FramePainter{**scene}, [](auto) { std::this_thread::sleep_for(1ms); });
        if (metrics && !write_metrics(job, *metrics)) ADD_FAILURE() << "cannot write metrics.json";
        return metrics;
    }
    HeadlessJob job(int frames) const {
        const auto path = CameraPath::parse(R"({"keys": [
            {"time": 0, "x": 5000000, "y": 6000000, "height": 300, "yaw": 10, "pitch": -70},
            {"time": 0.2, "x": 5001000, "y": 6000000, "height": 600, "yaw": 80, "pitch": -10}]})",
                                            "path", extent);
        return {.path = path.value(),
                .frames = frames,
                .width = 200,
                .height = 160,
                .folder = folder,
                .patience = 5s};
    }

    const Extent extent{18};
    const fs::path folder = fs::temp_directory_path() / ("tessera_headless_" + std::to_string(getpid()));

  private:
    std::unique_ptr<GlContext> context_;
};

TEST_F(HeadlessRun, SaysHowFarItIsAfterEachFrame) {
    FakePageSource source{noise_page, 1};
    source.deliver_at_once = 1000;
    HeadlessJob asked = job(3);
    std::vector<int> told;
    asked.progress = [&](int frames) { told.push_back(frames); };
    ASSERT_TRUE(run(asked, source));
    EXPECT_EQ(told, (std::vector{1, 2, 3}));
}

TEST_F(HeadlessRun, DrawsTheSameFramesWhateverTheOrderInWhichPagesCome) {
    std::vector<std::string> hashes[2];
    for (unsigned seed = 0; seed < 2; ++seed) {
        FakePageSource source{noise_page, seed + 1};
        source.deliver_at_once = seed == 0 ? 1000 : 2;
        const auto metrics = run(job(4), source);
        ASSERT_TRUE(metrics) << metrics.error().detail;
        for (const view::FrameMetrics& frame : metrics->frames()) hashes[seed].push_back(frame.hash());
    }
    EXPECT_EQ(hashes[0].size(), 4u);
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_NE(hashes[0][0], hashes[0][3]);
}

TEST_F(HeadlessRun, WritesItsFramesAndWhatItMeasured) {
    FakePageSource source{noise_page};
    const auto metrics = run(job(3), source);
    ASSERT_TRUE(metrics) << metrics.error().detail;
    std::ifstream stream{folder / "metrics.json"};
    const std::string json{std::istreambuf_iterator<char>{stream}, {}};
    view::RunMetrics read;
    ASSERT_TRUE(read_json(json, "metrics.json", read));
    EXPECT_EQ(read.frames_size(), 3);
    EXPECT_EQ(read.frames(2).file(), "frame_0002.png");
    EXPECT_EQ(read.frames(2).time(), 0.2);
    EXPECT_GT(read.frames(0).mip_deficit(), 1);
    EXPECT_EQ(read.totals().uploads(), read.totals().arrived());
    EXPECT_GT(read.totals().time_to_sharp_ms(), 0);
    for (const view::FrameMetrics& frame : read.frames()) EXPECT_TRUE(fs::exists(folder / frame.file()));
}

TEST_F(HeadlessRun, RunsFreelyByTheClockAndEndsSharp) {
    FakePageSource source{noise_page};
    source.deliver_at_once = 1;
    HeadlessJob free = job(10);
    free.settle = false;
    const auto metrics = run(free, source);
    ASSERT_TRUE(metrics) << metrics.error().detail;
    EXPECT_GE(metrics->totals().seconds(), 0.2);
    EXPECT_LT(metrics->totals().mean_resident_share(), 1);
    EXPECT_GT(metrics->totals().time_to_sharp_ms(), 0);
}

TEST_F(HeadlessRun, GivesUpWithTheServersWordsWhereNoPageComes) {
    FakePageSource source{noise_page};
    source.failing = Error{ErrorCode::io_failure, "cannot connect to 127.0.0.1:9"};
    HeadlessJob impatient = job(1);
    impatient.patience = 200ms;
    const auto metrics = run(impatient, source);
    ASSERT_FALSE(metrics);
    EXPECT_THAT(metrics.error().detail, ::testing::HasSubstr("cannot connect to 127.0.0.1:9"));
    EXPECT_THAT(metrics.error().detail, ::testing::HasSubstr("frame 0"));
}

TEST_F(HeadlessRun, SaysWhereItCannotWrite) {
    FakePageSource source{noise_page};
    HeadlessJob nowhere = job(1);
    nowhere.folder = "/proc/nowhere";
    const auto metrics = run(nowhere, source);
    ASSERT_FALSE(metrics);
    EXPECT_THAT(metrics.error().detail, ::testing::HasSubstr("/proc/nowhere"));
}

TEST(PngFile, HoldsThePixelsRowsFromTheTop) {
    Rgba8Image image{3, 2};
    for (std::size_t i = 0; i < image.bytes.size(); ++i) image.bytes[i] = static_cast<std::uint8_t>(10 * i);
    const fs::path file = fs::temp_directory_path() / ("tessera_png_" + std::to_string(getpid()) + ".png");
    ASSERT_TRUE(write_png(file, image));
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_file(&png, file.c_str()));
    png.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(png));
    ASSERT_TRUE(png_image_finish_read(&png, nullptr, read.data(), 0, nullptr));
    fs::remove(file);
    ASSERT_EQ(read.size(), image.bytes.size());
    for (std::size_t i = 0; i < read.size(); ++i) EXPECT_EQ(read[i], i % 4 == 3 ? 255 : image.bytes[i]);
}

}  // namespace
}  // namespace tessera
