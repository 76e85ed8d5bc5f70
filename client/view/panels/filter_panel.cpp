#include "client/view/panels/panels.h"

namespace tessera {

void filter_panel(PanelColumns& columns, ViewerSwitches& switches) {
    if (columns.begin(PanelColumns::Side::left, "Filter")) {
        FilterChoice& choice = switches.filter;
        ImGui::SetNextItemWidth(-1);
        if (ImGui::BeginCombo("##filter", title_of(choice.filter))) {
            for (const Filter filter : filters) {
                if (filter == Filter::driver_anisotropic && !has_driver_anisotropy()) continue;
                if (ImGui::Selectable(title_of(filter), filter == choice.filter)) choice.filter = filter;
            }
            ImGui::EndCombo();
        }
        ImGui::SetNextItemWidth(-1);
        if (choice.filter == Filter::line_integral)
            ImGui::SliderInt("##columns", &choice.columns, 2, 24, "at most %d lines across a pixel",
                             ImGuiSliderFlags_AlwaysClamp);
        if (choice.filter == Filter::supersample)
            ImGui::SliderInt("##subsamples", &choice.subsamples, 2, 8, "%d a side of each pixel",
                             ImGuiSliderFlags_AlwaysClamp);
        ImGui::Checkbox("haze", &switches.haze);
    }
    columns.end();
}

}  // namespace tessera
