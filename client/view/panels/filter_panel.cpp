#include <array>

#include "client/render/integral_store.h"
#include "client/view/panels/panels.h"

namespace tessera {
namespace {

void filter_choice(const char* id, FilterChoice& choice) {
    ImGui::PushID(id);
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
    ImGui::PopID();
}

bool reads_integrals(const ViewerSwitches& switches) {
    return switches.filter.filter == Filter::line_integral ||
           (switches.split && switches.split->filter.filter == Filter::line_integral);
}

void split_choice(ViewerSwitches& switches) {
    bool is_split = switches.split.has_value();
    if (ImGui::Checkbox("side by side", &is_split)) switch_split(switches);
    if (!switches.split) return;
    SplitChoice& split = *switches.split;
    ImGui::TextColored(panel_colours::quiet, "right of the line, which can be dragged:");
    if (ImGui::RadioButton("another filter", !split.is_second)) split.is_second = false;
    ImGui::SameLine();
    if (ImGui::RadioButton("another accuracy", split.is_second)) {
        split.is_second = true;
        split.filter = switches.filter;
    }
    if (!split.is_second) return filter_choice("right", split.filter);
    for (const Accuracy accuracy : accuracies) {
        if (accuracy != accuracies.front()) ImGui::SameLine();
        if (ImGui::RadioButton(std::string{name_of(accuracy)}.c_str(), switches.split_accuracy == accuracy))
            switches.split_accuracy = accuracy;
    }
}

}  // namespace

void view_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches) {
    if (columns.begin(PanelColumns::Side::left, "View", !columns.is_low())) {
        Surface& surface = switches.surface;
        for (const auto kind : {Surface::Kind::plane, Surface::Kind::terrain, Surface::Kind::corridor}) {
            if (kind != Surface::Kind::plane) ImGui::SameLine();
            if (ImGui::RadioButton(std::string{name_of(kind)}.c_str(), surface.kind == kind) &&
                surface.kind != kind) {
                surface.kind = kind;
                surface = around(surface, contents.view.camera());
            }
        }
        if (surface.kind == Surface::Kind::terrain) {
            auto relief = static_cast<float>(surface.relief);
            ImGui::SetNextItemWidth(-1);
            if (ImGui::SliderFloat("##relief", &relief, 0, 4, "hills × %.2f", ImGuiSliderFlags_AlwaysClamp))
                surface.relief = static_cast<double>(relief);
        }
        ImGui::Checkbox("a drag orbits", &switches.orbits);
        ImGui::SameLine(150 * columns.scale());
        ImGui::Checkbox("haze", &switches.haze);
    }
    columns.end();
}

void filter_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches) {
    if (columns.begin(PanelColumns::Side::left, "Filter")) {
        filter_choice("left", switches.filter);
        if (reads_integrals(switches)) {
            const std::size_t places = contents.plane.integral_places();
            wrapped(panel_colours::quiet,
                    text("sums of %zu pages: %.0f MB more on the GPU; fewer columns need fewer", places,
                         static_cast<double>(places * IntegralStore::page_bytes) / 1e6));
        }
        split_choice(switches);
    }
    columns.end();
}

}  // namespace tessera
