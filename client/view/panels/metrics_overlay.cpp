#include "client/view/metrics/session_metrics.h"
#include "client/view/panels/panels.h"
#include "client/view/view.pb.h"

namespace tessera {
namespace {

using namespace panel_colours;

void waits_rows(const view::MetricsLine& line) {
    if (line.waiting_for_sharp_ms() > 0)
        row("sharp in", text("%.0f ms so far", line.waiting_for_sharp_ms()), waiting);
    else
        row("sharp in", text("%.0f ms", line.time_to_sharp_ms_last()));
    row("p50, p99", text("%.0f, %.0f ms", line.time_to_sharp_ms_p50(), line.time_to_sharp_ms_p99()));
    row("edit visible", line.edits_seen() == 0 ? std::string{"none seen"}
                                               : text("%.0f ms, p99 %.0f", line.edit_to_visible_ms_last(),
                                                      line.edit_to_visible_ms_p99()));
    row("stale in view",
        line.stale_visible_pages() == 0
            ? std::string{"none"}
            : text("%u, for %.0f ms", line.stale_visible_pages(), line.stale_oldest_ms()),
        line.stale_visible_pages() == 0 ? plain : waiting);
}

void pages_rows(const view::MetricsLine& line) {
    row("sharp", text("%.1f %%, %.2f missing", 100 * line.sharp_fraction(), line.mip_deficit()));
    row("faults", text("%u in %u frames", line.page_faults(), line.frames_of_line()));
    row("over-fetch", text("%.2f: %llu came, %llu shown", line.over_fetch(),
                           static_cast<unsigned long long>(line.pages_received()),
                           static_cast<unsigned long long>(line.pages_shown())));
    row("late, unasked", text("%llu, %llu", static_cast<unsigned long long>(line.late_pages()),
                              static_cast<unsigned long long>(line.unasked_pages())));
    if (line.checked_pixels() > 0)
        row("wrong pixels",
            text("%.0f of %.1f million", line.wrong_page_pixels(), line.checked_pixels() / 1e6),
            line.wrong_page_pixels() > 0 ? bad : good);
}

void cost_rows(const view::MetricsLine& line) {
    row("frame p50", text("%.1f ms", line.frame_ms_p50()));
    row("p95, p99", text("%.1f, %.1f ms", line.frame_ms_p95(), line.frame_ms_p99()));
    row("hitches", text("%u of %llu frames", line.hitches(), static_cast<unsigned long long>(line.frames())),
        line.hitches_of_line() > 0 ? waiting : plain);
    row("uploads",
        text("%u; %.2f ms, worst %.2f", line.uploads(), line.upload_ms_mean(), line.upload_ms_worst()));
    row("cache",
        text("%u pages, %.0f MB", line.cache_pages(), static_cast<double>(line.cache_bytes()) / 1e6));
    row("credits", text("%u, %u in use", line.credit_window(), line.in_flight()));
    row("link", text("%.1f ms, %.1f Mb/s", line.round_trip_ms(), line.megabits_per_second()));
}

}  // namespace

void metrics_overlay(PanelColumns& columns, const PanelContents& contents) {
    if (columns.begin(PanelColumns::Side::right, "Figures")) {
        const view::MetricsLine line = contents.metrics.last_line();
        if (begin_rows("figures", contents.scale)) {
            waits_rows(line);
            pages_rows(line);
            cost_rows(line);
            ImGui::EndTable();
        }
    }
    columns.end();
}

}  // namespace tessera
