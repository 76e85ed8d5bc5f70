#include "client/view/metrics/session_metrics.h"

#include <algorithm>
#include <utility>

#include "client/view/view.pb.h"

namespace tessera {
namespace {

constexpr std::uint64_t frames_between_medians = 30;
constexpr double hitch = 2;  ///< Times the median

double milliseconds(ClientTime time) { return static_cast<double>(time.count()); }
std::uint32_t count(std::uint64_t number) { return static_cast<std::uint32_t>(number); }

}  // namespace

void SessionMetrics::add(const FrameSample& sample) {
    const ResidencyFrame& outcome = sample.outcome;
    const Residency& residency = sample.residency;
    const double now_ms = milliseconds(sample.time.now);
    if (frames_ == 0) line_.begin_ms = now_ms;
    ++frames_;
    ++line_.frames;
    if (sample.frame_ms > 0) {
        frame_times_.add(sample.frame_ms);
        if (median_ms_ > 0 && sample.frame_ms > hitch * median_ms_) {
            ++hitches_;
            ++line_.hitches;
        }
        if (frame_times_.size() == frames_between_medians || frames_ % frames_between_medians == 0)
            median_ms_ = frame_times_.percentile(0.5);
    }
    const std::span uploads{outcome.uploads};
    traffic_.add(uploads.first(uploads.size() - sample.second_uploads), outcome.sampled, residency,
                 sample.time.now, sample.time.step);
    if (sample.second)
        second_traffic_.add(uploads.last(sample.second_uploads), sample.second_sampled, *sample.second,
                            sample.time.now, sample.time.step);
    waits_.add(sample.camera, outcome, residency.versions().history(), residency.versions().told_revision(),
               sample.time.now);

    line_.end_ms = now_ms;
    line_.bytes_after = sample.bytes_received;
    line_.faults += traffic_.faults() + (sample.second ? second_traffic_.faults() : 0);
    line_.uploads += outcome.uploads.size();
    line_.sharp += outcome.resident_share;
    line_.deficit += outcome.mip_deficit;
    line_.work_ms += sample.work_ms;
    line_.upload_ms += sample.upload_ms;
    line_.worst_upload_ms = std::max(line_.worst_upload_ms, sample.upload_ms);
    checked_pixels_ += sample.checked_pixels;
    wrong_pixels_ += sample.wrong_pixels;

    const PageRequests& requests = residency.requests();
    const CreditWindow& window = requests.window();
    const auto waiting = waits_.waiting_for_sharp(sample.time.now);
    last_ = {
        .now_ms = now_ms,
        .needed = outcome.needed,
        .missing = outcome.missing,
        .stale = traffic_.stale_pages() + (sample.second ? second_traffic_.stale_pages() : 0),
        .stalest = std::max(traffic_.stalest(), sample.second ? second_traffic_.stalest() : ClientTime{}),
        .lod_bias = outcome.lod_bias,
        .cache_pages = residency.cache().size(),
        .gpu_bytes = sample.gpu_bytes,
        .in_flight = requests.in_flight(),
        .credits = window.answers(),
        .round_trip_ms = sample.round_trip_ms > 0 ? sample.round_trip_ms : milliseconds(window.round_trip()),
        .waiting_ms = waiting ? milliseconds(*waiting) : 0,
        .bytes_received = sample.bytes_received,
        .revision = sample.revision,
        .counts = requests.counts(),
        .evictions = residency.cache().evictions(),
        .trouble = sample.trouble,
        .undrawn_held = sample.undrawn_held,
        .unlifted_holds = outcome.unlifted_holds.size()};
}

view::MetricsLine SessionMetrics::of(const Line& part) const {
    view::MetricsLine line;
    const double frames = static_cast<double>(std::max<std::uint64_t>(part.frames, 1));
    const double seconds = (part.end_ms - part.begin_ms) / 1000;
    line.set_seconds(last_.now_ms / 1000);
    line.set_frames(frames_);
    line.set_frames_of_line(count(part.frames));
    line.set_frame_ms_p50(frame_times_.percentile(0.5));
    line.set_frame_ms_p95(frame_times_.percentile(0.95));
    line.set_frame_ms_p99(frame_times_.percentile(0.99));
    line.set_frame_ms_worst(frame_times_.worst());
    line.set_work_ms_mean(part.work_ms / frames);
    line.set_hitches(count(hitches_));
    line.set_hitches_of_line(count(part.hitches));

    line.set_sharp_fraction(part.frames == 0 ? 1 : part.sharp / frames);
    line.set_mip_deficit(part.deficit / frames);
    line.set_needed_pages(count(last_.needed));
    line.set_missing_pages(count(last_.missing));
    line.set_page_faults(count(part.faults));
    line.set_lod_bias(last_.lod_bias);
    line.set_waiting_for_sharp_ms(last_.waiting_ms);
    line.set_time_to_sharp_ms_last(waits_.to_sharp().last());
    line.set_time_to_sharp_ms_p50(waits_.to_sharp().percentile(0.5));
    line.set_time_to_sharp_ms_p99(waits_.to_sharp().percentile(0.99));

    line.set_stale_visible_pages(count(last_.stale));
    line.set_stale_oldest_ms(milliseconds(last_.stalest));
    line.set_edits_seen(count(waits_.edit_to_visible().size()));
    line.set_edit_to_visible_ms_last(waits_.edit_to_visible().last());
    line.set_edit_to_visible_ms_p99(waits_.edit_to_visible().percentile(0.99));
    line.set_revision(last_.revision);

    line.set_requests(last_.counts.requested);
    // Of both halves, each of its own cache
    const std::uint64_t received = traffic_.received() + second_traffic_.received(),
                        shown = traffic_.sampled() + second_traffic_.sampled();
    line.set_pages_received(received);
    line.set_pages_shown(shown);
    line.set_over_fetch(shown == 0 ? 1 : static_cast<double>(received) / static_cast<double>(shown));
    line.set_late_pages(last_.counts.late);
    line.set_unasked_pages(last_.counts.unasked);
    line.set_unchanged_pages(last_.counts.unchanged);
    line.set_cancelled_requests(last_.counts.cancelled);
    line.set_failed_requests(last_.counts.failed);
    line.set_in_flight(count(last_.in_flight));
    line.set_credit_window(count(last_.credits));
    line.set_round_trip_ms(last_.round_trip_ms);
    line.set_bytes_received(last_.bytes_received);
    line.set_megabits_per_second(
        seconds > 0 ? 8e-6 * static_cast<double>(part.bytes_after - part.bytes_before) / seconds : 0);

    line.set_uploads(count(part.uploads));
    line.set_upload_ms_mean(part.upload_ms / frames);
    line.set_upload_ms_worst(part.worst_upload_ms);
    line.set_cache_pages(count(last_.cache_pages));
    line.set_cache_bytes(last_.gpu_bytes);
    line.set_evictions(last_.evictions);
    line.set_checked_pixels(checked_pixels_);
    line.set_wrong_page_pixels(wrong_pixels_);
    line.set_trouble(last_.trouble);
    line.set_undrawn_held(count(last_.undrawn_held));
    line.set_unlifted_holds(count(last_.unlifted_holds));
    return line;
}

view::MetricsLine SessionMetrics::line() const { return of(line_); }
view::MetricsLine SessionMetrics::last_line() const { return of(ended_.frames > 0 ? ended_ : line_); }

void SessionMetrics::next_line() {
    ended_ = std::exchange(line_, {});
    line_.begin_ms = last_.now_ms;
    line_.bytes_before = last_.bytes_received;
}

}  // namespace tessera
