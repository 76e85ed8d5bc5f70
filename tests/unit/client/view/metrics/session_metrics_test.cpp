// The figures of a session, on a clock that the test turns.
#include "client/view/metrics/session_metrics.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "client/view/metrics/metrics_file.h"
#include "client/view/view.pb.h"
#include "shared/wire/json.h"
#include "tests/simulation/simulated_stream.h"

namespace tessera {
namespace {

using testing::SimulatedStream;

std::string blank(PageKey, std::uint32_t, std::uint64_t) { return std::string(slot_bytes, '\0'); }

TEST(RollingTimes, PercentilesAreOfTheLastTimesOnly) {
    RollingTimes times{100};
    EXPECT_EQ(times.percentile(0.5), 0);
    for (int i = 0; i < 50; ++i) times.add(1000);  // will be forgotten
    for (int i = 1; i <= 100; ++i) times.add(i);
    EXPECT_EQ(times.size(), 100u);
    EXPECT_EQ(times.percentile(0.5), 50);
    EXPECT_EQ(times.percentile(0.95), 95);
    EXPECT_EQ(times.percentile(0.99), 99);
    EXPECT_EQ(times.percentile(0), 1);
    EXPECT_EQ(times.worst(), 100);
    EXPECT_EQ(times.last(), 100);
    times.add(7);
    EXPECT_EQ(times.last(), 7);
    EXPECT_EQ(times.percentile(1), 100) << "1 went, not 100";
}

/// A view of pages over a link, 60 frames a second.
class Session : public ::testing::Test {
  protected:
    void frame(double frame_ms = 16, double upload_ms = 0) {
        now += ClientTime{16};
        stream.advance(now);
        const ResidencyFrame outcome = residency.update(PlaneView{camera, 320, 280}, now);
        metrics.add({.camera = camera,
                     .time = now,
                     .outcome = outcome,
                     .residency = residency,
                     .frame_ms = frame_ms,
                     .work_ms = frame_ms / 2,
                     .upload_ms = upload_ms,
                     .gpu_bytes = 1000,
                     .bytes_received = stream.bytes_sent,
                     .revision = stream.scene_revision()});
        sharp = outcome.is_sharp();
        sampled = outcome.sampled;
    }
    int frames_until_sharp() {
        for (int frames = 1;; ++frames) {
            frame();
            if (sharp || frames > 1000) return frames;
        }
    }

    SimulatedStream stream{{.bytes_per_second = 10e6, .one_way_ms = 20}, blank};
    Residency residency{Extent{14}, stream, {.slots = 256}};
    SessionMetrics metrics;
    Camera camera{.ground = {1'000'000, 1'000'000, 0.5, 0.5}, .height_texels = 300, .pitch_degrees = -60};
    ClientTime now{0};
    bool sharp = false;
    std::vector<NeededPage> sampled;
};

TEST_F(Session, TimeToSharpCountsFromTheFirstFrameAtRest) {
    const int first = frames_until_sharp();
    view::MetricsLine line = metrics.line();
    EXPECT_EQ(line.time_to_sharp_ms_last(), 16 * (first - 1));
    EXPECT_EQ(line.waiting_for_sharp_ms(), 0);
    EXPECT_LT(line.sharp_fraction(), 1);
    EXPECT_GT(line.mip_deficit(), 0);

    // Away, and a rest somewhere else; while it moves, nobody waits
    for (int i = 0; i < 10; ++i) {
        camera.ground = camera.ground.moved(3000, 0);
        frame();
        EXPECT_EQ(metrics.line().waiting_for_sharp_ms(), 0);
    }
    frame();
    EXPECT_FALSE(sharp);
    const int second = frames_until_sharp();
    line = metrics.line();
    EXPECT_EQ(line.time_to_sharp_ms_last(), 16 * second);
    EXPECT_EQ(line.time_to_sharp_ms_p99(), 16 * std::max(first - 1, second));
}

TEST_F(Session, AFaultIsCountedWhenAPageBecomesNeededNotWhileItIsMissing) {
    frame();
    EXPECT_EQ(metrics.line().page_faults(), sampled.size());
    frame();
    EXPECT_EQ(metrics.line().page_faults(), sampled.size()) << "the same are missing still";
    frames_until_sharp();
    metrics.next_line();
    frame();
    EXPECT_EQ(metrics.line().page_faults(), 0u);
    EXPECT_EQ(metrics.line().sharp_fraction(), 1);
    camera.ground = camera.ground.moved(100'000, 0);
    frame();
    EXPECT_GT(metrics.line().page_faults(), 0u);
}

TEST_F(Session, TheLastLineIsReadUntilTheNextOneEnds) {
    for (int i = 0; i < 5; ++i) frame();
    EXPECT_EQ(metrics.last_line().frames_of_line(), 5u) << "until then what there is";
    const double before = metrics.line().mip_deficit();
    metrics.next_line();
    EXPECT_EQ(metrics.line().frames_of_line(), 0u);
    EXPECT_EQ(metrics.last_line().frames_of_line(), 5u);
    EXPECT_EQ(metrics.last_line().mip_deficit(), before);
    frame();
    EXPECT_EQ(metrics.last_line().mip_deficit(), before) << "a line of few frames says little";
    EXPECT_EQ(metrics.last_line().frames(), 6u) << "what is no mean is of now";
    metrics.next_line();
    EXPECT_EQ(metrics.last_line().frames_of_line(), 1u);
}

TEST_F(Session, HalvesOfOtherAccuracyCountEachTheirOwnPages) {
    SimulatedStream other_stream{{.bytes_per_second = 10e6, .one_way_ms = 20}, blank};
    Residency other{Extent{14}, other_stream, {.slots = 256}};
    SessionMetrics both, whole;
    for (int i = 0; i < 400; ++i) {
        now += ClientTime{16};
        stream.advance(now);
        other_stream.advance(now);
        // The same view in both, so that the same pages come to each
        ResidencyFrame left = residency.update(PlaneView{camera, 320, 280}, now);
        ResidencyFrame right = other.update(PlaneView{camera, 320, 280}, now);
        whole.add({.camera = camera, .time = now, .outcome = left, .residency = residency});
        const std::size_t uploads = right.uploads.size();
        std::ranges::move(right.uploads, std::back_inserter(left.uploads));
        both.add({.camera = camera,
                  .time = now,
                  .outcome = left,
                  .residency = residency,
                  .second = &other,
                  .second_sampled = right.sampled,
                  .second_uploads = uploads});
    }
    EXPECT_EQ(both.line().pages_received(), 2 * whole.line().pages_received());
    EXPECT_EQ(both.line().pages_shown(), 2 * whole.line().pages_shown());
    EXPECT_DOUBLE_EQ(both.line().over_fetch(), whole.line().over_fetch());
}

TEST_F(Session, PagesThatNoFrameShowedAreFetchedInVain) {
    frames_until_sharp();
    for (int i = 0; i < 60; ++i) frame();
    const view::MetricsLine line = metrics.line();
    EXPECT_EQ(line.pages_received(), residency.cache().size());
    // The coarsest pages cover what there is, and are shown but in the first frames
    EXPECT_LE(line.pages_shown(), line.pages_received());
    EXPECT_GE(line.pages_shown(), sampled.size());
    EXPECT_DOUBLE_EQ(line.over_fetch(),
                     static_cast<double>(line.pages_received()) / static_cast<double>(line.pages_shown()));
    EXPECT_LT(line.over_fetch(), 4) << "21 pages of the coarsest levels, and few others here";
}

TEST_F(Session, AnEditIsVisibleOnceNoStalePageOfItIsInView) {
    frames_until_sharp();
    const PageKey seen = sampled.back().key;
    stream.edit({seen});
    double stale_ms = 0;
    int frames = 0;
    for (; metrics.line().edits_seen() == 0 && frames < 200; ++frames) {
        frame();
        const view::MetricsLine line = metrics.line();
        if (line.stale_visible_pages() > 0) {
            EXPECT_EQ(line.stale_visible_pages(), 1u);
            EXPECT_GE(line.stale_oldest_ms(), stale_ms);
            stale_ms = line.stale_oldest_ms();
        }
    }
    const view::MetricsLine line = metrics.line();
    EXPECT_EQ(line.edits_seen(), 1u);
    EXPECT_EQ(line.stale_visible_pages(), 0u);
    EXPECT_EQ(line.edit_to_visible_ms_last(), stale_ms + 16);
    EXPECT_GE(line.edit_to_visible_ms_last(), 40) << "a page is asked for and travels";
    EXPECT_LT(line.edit_to_visible_ms_last(), 120);
    EXPECT_EQ(line.revision(), 1u);

    stream.edit({PageKey{seen.level, 0, 0}});  // nobody looks there
    for (int i = 0; i < 20; ++i) frame();
    EXPECT_EQ(metrics.line().edits_seen(), 1u);
}

TEST_F(Session, AHitchIsAFrameOfTwiceTheMedian) {
    for (int i = 0; i < 100; ++i) frame(10 + i % 3);
    EXPECT_EQ(metrics.line().hitches(), 0u);
    frame(21);
    EXPECT_EQ(metrics.line().hitches(), 0u) << "the median is 11";
    frame(25);
    frame(100);
    EXPECT_EQ(metrics.line().hitches(), 2u);
    EXPECT_EQ(metrics.line().frame_ms_worst(), 100);
    EXPECT_EQ(metrics.line().frame_ms_p50(), 11);
    metrics.next_line();
    EXPECT_EQ(metrics.line().hitches_of_line(), 0u);
    EXPECT_EQ(metrics.line().hitches(), 2u);
}

TEST_F(Session, WritesALineASecondAndALineOfTheRest) {
    const auto path =
        std::filesystem::temp_directory_path() / ("tessera_metrics_" + std::to_string(getpid()) + ".jsonl");
    for (const bool every_frame : {false, true}) {
        auto file = MetricsFile::open(path, every_frame);
        ASSERT_TRUE(file) << file.error().detail;
        for (int i = 0; i < 150; ++i) {  // 2.4 s
            frame(16, i == 10 ? 1.5 : 0);
            ASSERT_TRUE(file->frame(metrics, now));
        }
        ASSERT_TRUE(file->end(metrics));
        std::ifstream written{path};
        std::vector<view::MetricsLine> lines;
        for (std::string text; std::getline(written, text);) {
            view::MetricsLine& line = lines.emplace_back();
            ASSERT_TRUE(read_json(text, "a line", line)) << text;
        }
        ASSERT_EQ(lines.size(), every_frame ? 150u : 3u);
        std::uint64_t frames = 0;
        for (const view::MetricsLine& line : lines) frames += line.frames_of_line();
        EXPECT_EQ(frames, 150u);
        if (!every_frame) {
            EXPECT_EQ(lines[0].upload_ms_worst(), 1.5);
            EXPECT_EQ(lines[1].upload_ms_worst(), 0);
        }
    }
    std::filesystem::remove(path);
    EXPECT_FALSE(MetricsFile::open("/no/such/folder/metrics.jsonl", false));
}

}  // namespace
}  // namespace tessera
