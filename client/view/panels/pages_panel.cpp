#include <optional>

#include "client/view/panels/panels.h"

namespace tessera {
namespace {

/// Taken when it is let go: the cache is not made anew for every pixel on the way.
void cache_size(ViewerSwitches& switches) {
    static std::optional<int> dragged;
    int pages = dragged.value_or(static_cast<int>(switches.cache_pages));
    ImGui::SetNextItemWidth(-1);
    ImGui::SliderInt("##cache", &pages, least_cache_pages, most_cache_pages, "cache of %d pages",
                     ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
    if (ImGui::IsItemDeactivatedAfterEdit()) switches.cache_pages = static_cast<std::size_t>(pages);
    dragged = ImGui::IsItemActive() ? std::optional{pages} : std::nullopt;
}

}  // namespace

void pages_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches) {
    using namespace panel_colours;
    const ResidencyFrame& frame = contents.frame;
    const Residency& residency = contents.plane.residency();
    if (columns.begin(PanelColumns::Side::left, "Pages", !columns.is_low())) {
        ImGui::PushStyleColor(ImGuiCol_PlotHistogram, frame.is_sharp() ? good : waiting);
        ImGui::ProgressBar(static_cast<float>(frame.resident_share), {-1, 6 * contents.scale}, "");
        ImGui::PopStyleColor();
        cache_size(switches);
        if (begin_rows("pages", contents.scale)) {
            const RequestCounts& counts = residency.requests().counts();
            row("sharp", text("%.0f %% of the picture", 100 * frame.resident_share),
                frame.is_sharp() ? good : waiting);
            row("missing", text("%zu of %zu, %.2f levels", frame.missing, frame.needed, frame.mip_deficit));
            row("cache", text("%zu of %zu, %.0f MB", residency.cache().size(), residency.cache().capacity(),
                              static_cast<double>(contents.plane.gpu_bytes()) / 1e6));
            row("in flight",
                text("%zu of %zu", residency.requests().in_flight(),
                     residency.settings().requests.in_flight) +
                    (contents.source.is_live ? text(", %.1f ms there and back", contents.source.round_trip_ms)
                                             : ""));
            row("requests",
                text("%llu, %llu cancelled, %llu failed", static_cast<unsigned long long>(counts.requested),
                     static_cast<unsigned long long>(counts.cancelled),
                     static_cast<unsigned long long>(counts.failed)));
            row("received", text("%.1f MB", static_cast<double>(contents.bytes_received) / 1e6));
            if (frame.stale > 0) row("changed", text("%zu shown as they were before", frame.stale), waiting);
            if (frame.lod_bias > 0)
                row("blurred", text("by %.2f levels: small cache", frame.lod_bias), waiting);
            ImGui::EndTable();
        }
    }
    columns.end();
}

}  // namespace tessera
