#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "client/residency/residency.h"
#include "client/view/metrics/page_traffic.h"
#include "client/view/metrics/rolling_times.h"
#include "client/view/metrics/waits.h"

namespace tessera::view {
class MetricsLine;
}

namespace tessera {

/// One frame as measured.
struct FrameSample {
    const Camera& camera;
    FrameTime time;
    const ResidencyFrame& outcome;
    const Residency& residency;
    /// Of a picture whose right half is of another cache: that, what it samples, and how many of the
    /// outcome's uploads, the last ones, are its own.
    const Residency* second = nullptr;
    std::span<const NeededPage> second_sampled{};
    std::size_t second_uploads = 0;
    double frame_ms = 0;   ///< From the frame before to this one; 0: unknown.
    double work_ms = 0;    ///< Deciding, uploading and drawing.
    double upload_ms = 0;  ///< Bringing pages and entries to the GPU.
    std::size_t gpu_bytes = 0;
    std::uint64_t bytes_received = 0;
    double round_trip_ms = 0;  ///< Of the link; 0: unknown.
    std::uint64_t revision = 0;
    std::string trouble{};         ///< Why nothing comes; empty: all is well.
    std::size_t undrawn_held = 0;  ///< As HeldSprites::undrawn().
    /// Pixels whose pages were compared with what was brought for them, and those that failed.
    double checked_pixels = 0, wrong_pixels = 0;
};

/// All figures of a session, from its frames. view.proto's MetricsLine says what each means. No GL, no clock.
class SessionMetrics {
  public:
    void add(const FrameSample& sample);

    /// What holds now; means and counts "of the line" are of the frames since the last next_line().
    view::MetricsLine line() const;
    /// The same, of the last line that was ended, so that it can be read; until then as line().
    view::MetricsLine last_line() const;
    void next_line();

    std::uint64_t frames() const { return frames_; }
    const RollingTimes& frame_times() const { return frame_times_; }

  private:
    struct Line {
        std::uint64_t frames = 0, faults = 0, uploads = 0, hitches = 0;
        double begin_ms = 0, end_ms = 0;
        double sharp = 0, deficit = 0, upload_ms = 0, worst_upload_ms = 0, work_ms = 0;
        std::uint64_t bytes_before = 0, bytes_after = 0;
    };
    view::MetricsLine of(const Line& line) const;

    RollingTimes frame_times_{600};
    PageTraffic traffic_, second_traffic_;
    Waits waits_;
    double median_ms_ = 0;  ///< Of frame_times_, some frames ago
    std::uint64_t frames_ = 0, hitches_ = 0;
    double checked_pixels_ = 0, wrong_pixels_ = 0;

    Line line_, ended_;
    // Of the last frame
    struct Last {
        double now_ms = 0;
        std::size_t needed = 0, missing = 0, stale = 0;
        ClientTime stalest{};
        double lod_bias = 0;
        std::size_t cache_pages = 0, gpu_bytes = 0, in_flight = 0, credits = 0;
        double round_trip_ms = 0, waiting_ms = 0;
        std::uint64_t bytes_received = 0, revision = 0;
        RequestCounts counts{};
        std::uint64_t evictions = 0;
        std::string trouble{};
        std::size_t undrawn_held = 0, unlifted_holds = 0;
    } last_;
};

}  // namespace tessera
