#include <algorithm>

#include "client/view/panels/panels.h"

namespace tessera {

void frames_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches) {
    const double mean = contents.times.mean_milliseconds();
    const std::string title = text("Frames: %.0f a second###frames", mean > 0 ? 1000 / mean : 0);
    if (columns.begin(PanelColumns::Side::left, title.c_str(), false)) {
        ImGui::PlotLines("##times", contents.times.values().data(),
                         static_cast<int>(contents.times.values().size()), contents.times.oldest(),
                         text("%.1f ms", mean).c_str(), 0, static_cast<float>(std::max(33.0, 2 * mean)),
                         {ImGui::GetContentRegionAvail().x, 36 * contents.scale});
        ImGui::Checkbox("fade in", &switches.fade);
        ImGui::SameLine(150 * contents.scale);
        ImGui::Checkbox("vsync", &switches.vsync);
    }
    columns.end();
}

}  // namespace tessera
