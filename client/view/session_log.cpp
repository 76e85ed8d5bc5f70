#include "client/view/session_log.h"

#include "client/view/view.pb.h"

namespace tessera {
namespace {

constexpr ClientTime between_checks{1000};
constexpr std::size_t pages_checked = 16;  ///< Read back at once: 4.5 MB

}  // namespace

Result<std::unique_ptr<SessionLog>> SessionLog::open(const SessionLogOptions& options) {
    std::unique_ptr<SessionLog> log{new SessionLog{options}};
    if (!options.metrics.empty()) {
        auto file = MetricsFile::open(options.metrics, options.every_frame);
        if (!file) return file.error();
        log->file_.emplace(std::move(*file));
    }
    if (!options.record.empty()) {
        auto recorder =
            SessionRecorder::open(options.record, static_cast<std::uint64_t>(1e6 * options.record_megabytes));
        if (!recorder) return recorder.error();
        log->recorder_ = std::move(*recorder);
    }
    return log;
}

PageSource& SessionLog::begin(const std::string& scene, Extent extent, PageSource& source,
                              const ResidencySettings& settings) {
    return recorder_ ? recorder_->begin(scene, extent, source, settings) : source;
}

PageSource& SessionLog::begin_second(PageSource& source, const ResidencySettings& settings) {
    return recorder_ ? recorder_->begin_second(source, settings) : source;
}

void SessionLog::end_second() {
    if (recorder_) recorder_->end_second();
}

void SessionLog::resized(std::size_t slots) {
    if (recorder_) recorder_->resize(slots);
}

void SessionLog::pattern(std::int32_t pattern, const Rgba8Image& image, double side_texels) {
    if (recorder_) recorder_->pattern(pattern, image, side_texels);
}

void SessionLog::updated(const ViewFrame& frame) {
    if (recorder_) recorder_->frame(frame);
}

void SessionLog::drawn(const FrameTarget& target) {
    if (!recorder_) return;
    recorder_->picture(options_.record_hashes ? std::optional{hash_of_picture(target.read())} : std::nullopt);
}

void SessionLog::drawn(std::uint64_t hash) {
    if (recorder_) recorder_->picture(hash);
}

void SessionLog::measured(const ViewFrame& frame, const ResidencyFrame& outcome, const FramePainter& painter,
                          const Costs& costs) {
    const PlaneScene& scene = painter.scene();
    PageIdentity::Checked checked;
    // Of two scenes the pages are mixed in `outcome`
    if (options_.check_pages && !painter.second()) {
        const std::size_t slots = scene.residency().slots();
        if (std::exchange(known_slots_, slots) != slots) identity_.forget();
        identity_.add(outcome);
        if (!next_check_ || frame.time.now >= *next_check_) {
            checked = identity_.check(scene, outcome.sampled, pages_checked);
            next_check_ = frame.time.now + between_checks;
        }
    }
    const auto& beside = painter.beside();
    metrics_.add({.camera = frame.camera,
                  .time = frame.time,
                  .outcome = outcome,
                  .residency = scene.residency(),
                  .second = beside ? &painter.second()->residency() : nullptr,
                  .second_sampled = beside ? std::span{beside->sampled} : std::span<const NeededPage>{},
                  .second_uploads = beside ? beside->uploads : 0,
                  .frame_ms = costs.frame_ms,
                  .work_ms = costs.work_ms,
                  .upload_ms = scene.upload_ms(),
                  .gpu_bytes = scene.gpu_bytes(),
                  .bytes_received = costs.bytes_received,
                  .round_trip_ms = costs.link.round_trip_ms,
                  .revision = costs.link.revision,
                  .trouble = costs.link.trouble,
                  .undrawn_held = scene.held_patterns().undrawn(),
                  .checked_pixels = checked.pixels,
                  .wrong_pixels = checked.wrong});
    if (!file_) {  // the overlay's figures are of the last second too
        if (!next_line_) next_line_ = frame.time.now + between_checks;
        if (frame.time.now >= *next_line_) {
            metrics_.next_line();
            next_line_ = frame.time.now + between_checks;
        }
        return;
    }
    if (!trouble_.empty()) return;
    if (const auto written = file_->frame(metrics_, frame.time.now); !written)
        trouble_ = written.error().detail;
}

std::string SessionLog::end() {
    if (file_ && trouble_.empty())
        if (const auto written = file_->end(metrics_); !written) trouble_ = written.error().detail;
    std::string all = trouble_;
    if (recorder_ && !recorder_->problem().empty())
        all += (all.empty() ? "" : "; ") + ("the recording ended early: " + recorder_->problem());
    recorder_.reset();
    return all;
}

}  // namespace tessera
