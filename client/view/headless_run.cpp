#include "client/view/headless_run.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <thread>
#include <utility>
#include <vector>

#include "client/render/gl_context.h"
#include "client/view/frame_painter.h"
#include "client/view/png_file.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t uploads_unseen = 64;  ///< A frame, where nobody sees that it is late

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

std::string text_of_hash(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

/// One run: the frames one after the other, and what they cost.
class Run {
  public:
    Run(const HeadlessJob& job, FramePainter painter,
        const std::function<void(std::chrono::milliseconds)>& wait)
        : job_{job}, painter_{painter}, wait_{wait}, target_{job.width, job.height} {}

    Result<view::RunMetrics> all_frames() {
        begin_ = Clock::now();
        for (int i = 0; i < job_.frames; ++i) {
            if (const auto done = one_frame(i); !done) return done.error();
            if (job_.progress) job_.progress(i + 1);
        }
        if (!job_.settle) {
            const auto stopped = Clock::now();
            ViewFrame last = frame_at(job_.path.end_seconds());
            view::FrameMetrics after;
            if (const auto sharp = until_current(last, after); !sharp) return sharp.error();
            metrics_.mutable_totals()->set_time_to_sharp_ms(milliseconds_since(stopped));
        }
        sum_up();
        return std::move(metrics_);
    }

  private:
    ClientTime now() const {
        return std::chrono::duration_cast<ClientTime>(Clock::now() - begin_) + ClientTime{1};
    }

    FrameTime frame_time() const {
        if (step_) return {now(), *step_};
        if (!job_.source) return {now()};
        const ViewSource::SceneTime scene = job_.source->scene_time();
        return {now(), scene.step, job_.settle ? 0 : scene.steps_per_second};
    }

    ViewFrame frame_at(double time) const {
        return {.camera = job_.path.at(time),
                .width = job_.width,
                .height = job_.height,
                .time = frame_time(),
                .filter = job_.filter,
                .fade_ms = job_.settle ? 0.0F : 150.0F,
                .overlay = job_.overlay,
                .surface = job_.surface,
                .split = job_.split,
                .most_uploads = job_.settle ? uploads_unseen : painter_.scene().upload_budget().pages()};
    }

    ResidencyFrame update(ViewFrame& shown, view::FrameMetrics& frame) {
        shown.time = frame_time();
        const auto started = Clock::now();
        const auto requested = painter_.scene().residency().requests().counts().requested;
        ResidencyFrame outcome = painter_.update(shown);
        frame.set_requests(frame.requests() +
                           static_cast<std::uint32_t>(
                               painter_.scene().residency().requests().counts().requested - requested));
        frame.set_uploads(frame.uploads() + static_cast<std::uint32_t>(outcome.uploads.size()));
        const double update_ms = milliseconds_since(started);
        frame.set_update_ms(frame.update_ms() + update_ms);
        // The scene's clock is known once it has answered; frames that settle are all of the step that it had
        if (job_.settle && !step_ && painter_.scene().residency().requests().counts().arrived > 0)
            step_ = shown.time.step;
        tell(shown, outcome, update_ms);
        return outcome;
    }

    void tell(const ViewFrame& shown, const ResidencyFrame& outcome, double update_ms) {
        const auto last = std::exchange(last_update_, Clock::now());
        if (!job_.log) return;
        job_.log->updated(shown);
        SessionLog::Costs costs{.work_ms = update_ms + std::exchange(draw_ms_, 0)};
        if (last) costs.frame_ms = milliseconds_since(*last);
        if (job_.source) {
            costs.bytes_received = job_.source->bytes_received();
            costs.link = job_.source->state();
        }
        job_.log->measured(shown, outcome, painter_, costs);
    }

    Result<void> until_current(ViewFrame& shown, view::FrameMetrics& frame) {
        auto last_arrival = Clock::now();
        for (ResidencyFrame outcome = update(shown, frame); !outcome.is_current();
             outcome = update(shown, frame)) {
            if (!outcome.uploads.empty()) last_arrival = Clock::now();
            const PageRequests& requests = painter_.scene().residency().requests();
            if (Clock::now() - last_arrival > job_.patience) {
                return Error{ErrorCode::io_failure,
                             std::to_string(outcome.missing + outcome.stale) + " pages did not come within " +
                                 std::to_string(job_.patience.count() / 1000) + " s" +
                                 (requests.problem().empty() ? "" : ": " + requests.problem())};
            }
            // An arrival ends the wait; a back-off ends by itself
            wait_(std::chrono::milliseconds{requests.in_flight() > 0 ? 20 : 5});
            if (requests.in_flight() == 0) std::this_thread::sleep_for(std::chrono::milliseconds{2});
        }
        return {};
    }

    Result<void> one_frame(int index) {
        const double begin = job_.path.begin_seconds(), end = job_.path.end_seconds();
        const double time = job_.frames == 1 ? begin : begin + (end - begin) * index / (job_.frames - 1);
        if (!job_.settle) std::this_thread::sleep_until(begin_ + std::chrono::duration<double>(time - begin));
        const auto started = Clock::now();
        ViewFrame shown = frame_at(time);
        view::FrameMetrics& frame = *metrics_.add_frames();
        const ResidencyFrame first = update(shown, frame);
        frame.set_time(time);
        frame.set_needed_pages(static_cast<std::uint32_t>(first.needed));
        frame.set_missing_pages(static_cast<std::uint32_t>(first.missing));
        frame.set_mip_deficit(first.mip_deficit);
        frame.set_resident_share(first.resident_share);
        frame.set_lod_bias(first.lod_bias);
        if (job_.settle) {
            if (const auto sharp = until_current(shown, frame); !sharp)
                return Error{sharp.error().code,
                             "frame " + std::to_string(index) + ": " + sharp.error().detail};
            frame.set_time_to_sharp_ms(milliseconds_since(started));
        }
        const auto drawing = Clock::now();
        if (const auto drawn = painter_.draw(shown, target_); !drawn) return drawn.error();
        const Rgba8Image image = target_.read();
        draw_ms_ = milliseconds_since(drawing);
        frame.set_draw_ms(draw_ms_);
        const std::uint64_t hash = hash_of_picture(image);
        if (job_.log) job_.log->drawn(hash);
        char name[32];
        std::snprintf(name, sizeof name, "frame_%04d.png", index);
        frame.set_file(name);
        frame.set_hash(text_of_hash(hash));
        return write_png(job_.folder / name, image);
    }

    void sum_up() {
        const RequestCounts& counts = painter_.scene().residency().requests().counts();
        view::Totals& totals = *metrics_.mutable_totals();
        metrics_.set_renderer(gl_description());
        metrics_.set_width(static_cast<std::uint32_t>(job_.width));
        metrics_.set_height(static_cast<std::uint32_t>(job_.height));
        metrics_.set_settled(job_.settle);
        totals.set_frames(static_cast<std::uint32_t>(metrics_.frames_size()));
        totals.set_seconds(milliseconds_since(begin_) / 1000);
        totals.set_requests(static_cast<std::uint32_t>(counts.requested));
        totals.set_arrived(static_cast<std::uint32_t>(counts.arrived));
        totals.set_cancelled(static_cast<std::uint32_t>(counts.cancelled));
        totals.set_failed(static_cast<std::uint32_t>(counts.failed));
        totals.set_evictions(static_cast<std::uint32_t>(painter_.scene().residency().cache().evictions()));
        std::vector<double> costs;
        double deficit = 0, share = 0;
        for (const view::FrameMetrics& frame : metrics_.frames()) {
            totals.set_uploads(totals.uploads() + frame.uploads());
            if (job_.settle)
                totals.set_time_to_sharp_ms(std::max(totals.time_to_sharp_ms(), frame.time_to_sharp_ms()));
            costs.push_back(frame.update_ms() + frame.draw_ms());
            deficit += frame.mip_deficit();
            share += frame.resident_share();
        }
        std::ranges::sort(costs);
        totals.set_mean_mip_deficit(deficit / job_.frames);
        totals.set_mean_resident_share(share / job_.frames);
        totals.set_frame_ms_median(costs[costs.size() / 2]);
        totals.set_frame_ms_worst(costs.back());
    }

    const HeadlessJob& job_;
    FramePainter painter_;
    const std::function<void(std::chrono::milliseconds)>& wait_;
    FrameTarget target_;
    Clock::time_point begin_;
    std::optional<Clock::time_point> last_update_;
    double draw_ms_ = 0;
    std::optional<Step> step_{job_.step};
    view::RunMetrics metrics_;
};

}  // namespace

Result<view::RunMetrics> run_headless(const HeadlessJob& job, FramePainter painter,
                                      const std::function<void(std::chrono::milliseconds)>& wait) {
    std::error_code failed;
    std::filesystem::create_directories(job.folder, failed);
    if (failed)
        return Error{ErrorCode::io_failure, job.folder.string() + ": cannot be made: " + failed.message()};
    return Run{job, painter, wait}.all_frames();
}

Result<void> write_metrics(const HeadlessJob& job, const view::RunMetrics& metrics) {
    const auto file = job.folder / "metrics.json";
    std::ofstream stream{file, std::ios::binary};
    stream << write_json(metrics) << std::flush;
    if (stream) return {};
    return Error{ErrorCode::io_failure, file.string() + ": cannot be written"};
}

}  // namespace tessera
