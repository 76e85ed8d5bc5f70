// A session that was recorded is drawn again, pixel by pixel, from its file alone.
#include "client/view/record/replay.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <unistd.h>

#include "client/residency/height_field.h"
#include "client/view/frame_painter.h"
#include "client/view/record/session.pb.h"
#include "client/view/record/session_file.h"
#include "client/view/record/session_recorder.h"
#include "tests/simulation/simulated_stream.h"
#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::LinkSettings;
using testing::SimulatedStream;

constexpr Extent extent{14};

/// Noise of a version.
std::string paint(PageKey page, std::uint32_t, std::uint64_t revision) {
    return testing::paint_page(page, [&](int level, std::int64_t x, std::int64_t y) {
        testing::Code4 code = testing::noise_texel(level, x, y);
        code[0] = static_cast<std::uint8_t>(code[0] + 50 * revision);
        return code;
    });
}

class Record : public ::testing::Test {
  protected:
    void TearDown() override { fs::remove_all(folder); }

    /// A flight over a link that loses, doubles and delays pages, breaks once and carries edits; by several
    /// filters, surfaces and sizes. The hashes of its pictures.
    std::vector<std::uint64_t> fly(SessionRecorder& recorder, int frames) {
        SimulatedStream stream{{.bytes_per_second = 4e6,
                                .one_way_ms = 10,
                                .loss = 0.03,
                                .duplicates = 0.03,
                                .most_delay_ms = 30},
                               paint};
        const ResidencySettings settings{.slots = 96, .stand_ins = 4};
        PageSource& source = recorder.begin("made", extent, stream, settings);
        auto scene = PlaneScene::make(extent, source, settings);
        if (!scene) throw std::runtime_error{scene.error().detail};
        FramePainter painter{**scene};
        const auto heights = std::make_shared<HeightImage>(2, 2, std::vector<std::uint16_t>{0, 300, 90, 700});
        std::unique_ptr<SimulatedStream> split_source;
        std::unique_ptr<PlaneScene> split_scene;
        std::vector<std::uint64_t> hashes;
        ClientTime now{1};
        for (int i = 0; i < frames; ++i, now += ClientTime{16}) {
            stream.advance(now);
            ViewFrame frame;
            frame.camera = {.ground = {1'000'000 + 40 * i, 1'000'000, 0.25, 0.5},
                            .height_texels = 200.0 + 3 * i,
                            .yaw_degrees = 2.0 * i,
                            .pitch_degrees = -50};
            frame.width = i < 10 ? 120 : 160;
            frame.height = 100;
            frame.time = {now, i, 60.0};
            frame.fade_ms = 150;
            frame.most_uploads = static_cast<std::size_t>(2 + i % 7);
            if (is_plain) frame.fade_ms = 0;
            if (!is_plain && i % 5 == 2) frame.filter.filter = Filter::line_integral;
            if (!is_plain && i % 7 == 3)
                frame.split = SplitChoice{.at = 0.3, .filter = {.filter = Filter::nearest}};
            if (!is_plain && i % 11 == 4)
                frame.surface = {.kind = Surface::Kind::terrain, .heights = heights};
            if (i % 6 == 0 && i > 0) stream.edit({painter.scene().residency().table().centre_page(2)});
            if (i == 20) stream.disconnect(100, false);
            if (!is_plain && i % 13 == 5) {
                split_source = std::make_unique<SimulatedStream>(LinkSettings{}, paint, 7);
                split_scene = std::move(
                    PlaneScene::make(extent, recorder.begin_second(*split_source, settings), settings)
                        .value());
                painter.set_second(split_scene.get());
            }
            if (split_source) {
                split_source->advance(now);
                frame.split = SplitChoice{.at = 0.6, .is_second = true};
            }
            painter.update(frame);
            recorder.frame(frame);
            if (split_source && i % 13 == 9) {
                recorder.end_second();
                painter.set_second(nullptr);
                split_scene.reset();
                split_source.reset();
                continue;
            }
            if (i % 4 == 3) continue;
            const FrameTarget target{frame.width, frame.height};
            if (const auto drawn = painter.draw(frame, target); !drawn)
                throw std::runtime_error{drawn.error().detail};
            hashes.push_back(hash_of_picture(target.read()));
            recorder.picture(hashes.back());
        }
        return hashes;
    }
    /// Plainly: in one way, since each other one takes a shader.
    std::vector<std::uint64_t> record(int frames, std::uint64_t most_bytes = 1u << 30) {
        auto recorder = SessionRecorder::open(file, most_bytes);
        if (!recorder) throw std::runtime_error{recorder.error().detail};
        auto hashes = fly(**recorder, frames);
        problem = (*recorder)->problem();
        return hashes;
    }
    Result<ReplayReport> replayed() const {
        return replay(file, [](const FrameTarget&, std::uint64_t) { return true; });
    }
    std::string bytes() const {
        std::ifstream stream{file, std::ios::binary};
        return {std::istreambuf_iterator<char>{stream}, {}};
    }
    void write(const std::string& all) const { std::ofstream{file, std::ios::binary} << all; }

    static fs::path make_folder() {
        const fs::path made = fs::temp_directory_path() / ("tessera_record_" + std::to_string(getpid()));
        fs::create_directories(made);
        return made;
    }
    const std::unique_ptr<GlContext> context = testing::headless_context();
    const fs::path folder = make_folder(), file = folder / "session";
    std::string problem;
    bool is_plain = true;
};

TEST_F(Record, IsDrawnAgainWithEqualHashes) {
    is_plain = false;
    const auto hashes = record(40);
    std::vector<std::uint64_t> others = hashes;
    std::ranges::sort(others);
    ASSERT_GT(std::ranges::unique(others).begin() - others.begin(), 18) << "there is something to compare";
    {
        const auto report = replayed();
        ASSERT_TRUE(report) << report.error().detail;
        EXPECT_TRUE(report->is_equal()) << text_of(*report);
        EXPECT_EQ(report->frames, 40u);
        EXPECT_EQ(report->hashed, hashes.size());
        EXPECT_EQ(report->equal, hashes.size());
        EXPECT_EQ(report->end, "closed");
        EXPECT_EQ(report->scene, "made");
    }
}

TEST_F(Record, AnotherPictureIsTold) {
    record(12);
    // The same session with one page's texels changed
    auto reader = SessionReader::open(file);
    ASSERT_TRUE(reader);
    const fs::path changed = folder / "changed";
    {
        auto writer = SessionWriter::open(changed);
        ASSERT_TRUE(writer);
        bool is_done = false;
        for (view::SessionEntry entry; reader->next(entry);) {
            if (entry.has_frame() && !is_done)
                for (auto& batch : *entry.mutable_frame()->mutable_sources(0)->mutable_arrivals())
                    for (auto& page : *batch.mutable_pages())
                        if (page.texels().size() == slot_bytes) {
                            page.mutable_texels()->assign(slot_bytes, '\x55');
                            is_done = true;
                        }
            ASSERT_TRUE((*writer)->add(entry));
        }
        ASSERT_TRUE(is_done);
    }
    const auto report = replay(changed, [](const FrameTarget&, std::uint64_t) { return true; });
    ASSERT_TRUE(report) << report.error().detail;
    EXPECT_FALSE(report->is_equal());
    EXPECT_LT(report->equal, report->hashed);
    EXPECT_THAT(text_of(*report), HasSubstr("recorded"));
}

TEST_F(Record, ATornFileIsGoodUpToWhereItIsTorn) {
    record(30);
    const std::string whole = bytes();
    std::uint64_t last = 0;
    for (const double share : {0.3, 0.6, 0.9, 0.9999}) {
        write(whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
        const auto report = replayed();
        ASSERT_TRUE(report) << report.error().detail;
        EXPECT_EQ(report->equal, report->hashed);
        EXPECT_GE(report->frames, last);
        EXPECT_LE(report->frames, 30u);
        last = report->frames;
        EXPECT_THAT(report->trouble, AllOf(HasSubstr(file.string()), HasSubstr("torn"), HasSubstr("entry")));
        EXPECT_FALSE(report->is_equal()) << "all that there is is equal, but not all is there";
    }
    EXPECT_GT(last, 20u);
}

TEST_F(Record, ADamagedFileIsGoodUpToWhereItIsDamaged) {
    record(20);
    std::string all = bytes();
    all[all.size() / 2] = static_cast<char>(all[all.size() / 2] ^ 0x10);
    write(all);
    const auto report = replayed();
    ASSERT_TRUE(report) << report.error().detail;
    EXPECT_EQ(report->equal, report->hashed);
    EXPECT_LT(report->frames, 20u);
    EXPECT_THAT(report->trouble, ::testing::AnyOf(HasSubstr("damaged"), HasSubstr("torn")));
}

TEST_F(Record, AnotherVersionIsRefusedByName) {
    record(2);
    std::string all = bytes();
    all[16] = 9;
    write(all);
    const auto report = replayed();
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().detail,
                AllOf(HasSubstr(file.string()), HasSubstr("version 9"), HasSubstr("knows 1")));
}

TEST_F(Record, WhatIsNoSessionIsRefused) {
    write("some text");
    EXPECT_THAT(replayed().error().detail, HasSubstr("no recorded session"));
    fs::remove(file);
    EXPECT_THAT(replayed().error().detail, HasSubstr("cannot be read"));
    EXPECT_FALSE(SessionRecorder::open("/no/such/folder/session", 1000));
}

TEST_F(Record, EndsAtItsLimitAndSaysSo) {
    record(60, 3'000'000);
    EXPECT_THAT(problem, HasSubstr("limit of 3 MB"));
    EXPECT_LT(fs::file_size(file), 40'000'000u) << "what waited for the disk came on top";
    const auto report = replayed();
    ASSERT_TRUE(report) << report.error().detail;
    EXPECT_TRUE(report->is_equal()) << text_of(*report);
    EXPECT_THAT(report->end, HasSubstr("limit"));
    EXPECT_LT(report->frames, 60u);
}

}  // namespace
}  // namespace tessera
