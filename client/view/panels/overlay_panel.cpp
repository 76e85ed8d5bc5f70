#include <algorithm>
#include <array>
#include <cmath>

#include "client/view/panels/panels.h"

namespace tessera {
namespace {

constexpr std::array titles{"none", "borders by level", "age: how long shown", "revision: how lately edited"};

ImU32 colour_of(const std::array<float, 3>& hue) {
    return ImGui::ColorConvertFloat4ToU32({hue[0], hue[1], hue[2], 1});
}

/// A bar of colours from one side of the panel to the other, and words below it.
void ramp(float scale, const char* left, const char* middle, const char* right) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = 10 * scale;
    constexpr int parts = 24;
    for (int i = 0; i < parts; ++i) {
        const auto part = [&](int index) { return static_cast<float>(index) / parts; };
        const ImU32 from = colour_of(hue_of_age(part(i))), to = colour_of(hue_of_age(part(i + 1)));
        ImGui::GetWindowDrawList()->AddRectFilledMultiColor(
            {at.x + width * part(i), at.y}, {at.x + width * part(i + 1), at.y + height}, from, to, to, from);
    }
    ImGui::Dummy({width, height});
    const float begin = ImGui::GetCursorPosX();
    ImGui::TextColored(panel_colours::quiet, "%s", left);
    ImGui::SameLine(begin + (width - ImGui::CalcTextSize(middle).x) / 2);
    ImGui::TextColored(panel_colours::quiet, "%s", middle);
    ImGui::SameLine(begin + width - ImGui::CalcTextSize(right).x);
    ImGui::TextColored(panel_colours::quiet, "%s", right);
}

/// A square for each level around the one under the cursor.
void levels(const PanelContents& contents) {
    const int top = contents.scene.extent.n;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, side = width / static_cast<float>(top + 1);
    const float height = 12 * contents.scale;
    for (int level = 0; level <= top; ++level) {
        const float x = at.x + side * static_cast<float>(level);
        ImGui::GetWindowDrawList()->AddRectFilled({x + 1, at.y}, {x + side - 1, at.y + height},
                                                  colour_of(hue_of_level(level)), 2);
    }
    ImGui::Dummy({width, height});
    const float begin = ImGui::GetCursorPosX();
    ImGui::TextColored(panel_colours::quiet, "level 0, finest");
    const std::string last = std::to_string(top);
    ImGui::SameLine(begin + width - ImGui::CalcTextSize(last.c_str()).x);
    ImGui::TextColored(panel_colours::quiet, "%s", last.c_str());
}

}  // namespace

void overlay_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches) {
    if (columns.begin(PanelColumns::Side::left, "Overlay", switches.overlay != Overlay::none)) {
        ImGui::SetNextItemWidth(-1);
        if (ImGui::BeginCombo("##overlay", titles[static_cast<std::size_t>(switches.overlay)])) {
            for (const Overlay overlay : overlays)
                if (ImGui::Selectable(titles[static_cast<std::size_t>(overlay)], overlay == switches.overlay))
                    switches.overlay = overlay;
            ImGui::EndCombo();
        }
        if (switches.overlay == Overlay::level) levels(contents);
        if (switches.overlay == Overlay::age) ramp(contents.scale, "new", "8 s", "2 min");
        if (switches.overlay == Overlay::revision) {
            ramp(contents.scale, "last edit", "16 ago", "256 ago");
            ImGui::TextColored(panel_colours::quiet, "no tint: never edited");
        }
    }
    columns.end();
}

void split_labels(const PanelContents& contents, const ViewerSwitches& switches) {
    if (!switches.split) return;
    const SplitChoice& split = *switches.split;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float x = static_cast<float>(split.at) * screen.x, y = screen.y - 34 * contents.scale,
                gap = 10 * contents.scale;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto label = [&](const std::string& words, bool is_left) {
        const ImVec2 size = ImGui::CalcTextSize(words.c_str());
        const float left = is_left ? x - gap - size.x : x + gap;
        const float pad = 6 * contents.scale;
        list.AddRectFilled({left - pad, y - pad / 2}, {left + size.x + pad, y + size.y + pad / 2},
                           IM_COL32(14, 17, 21, 200), 4 * contents.scale);
        list.AddText({left, y}, IM_COL32(235, 240, 245, 255), words.c_str());
    };
    if (split.is_second) {
        label("accuracy " + std::string{name_of(switches.accuracy)}, true);
        label("accuracy " + std::string{name_of(switches.split_accuracy)}, false);
    } else {
        label(title_of(switches.filter.filter), true);
        label(title_of(split.filter.filter), false);
    }
    // A handle to take the line by
    const ImVec2 middle{x, screen.y / 2};
    list.AddCircleFilled(middle, 9 * contents.scale, IM_COL32(240, 245, 250, 255));
    const float arrow = 4 * contents.scale;
    for (const float side : {-1.0F, 1.0F})
        list.AddTriangleFilled({x + side * 1.6F * arrow, middle.y},
                               {x + side * 0.6F * arrow, middle.y - arrow},
                               {x + side * 0.6F * arrow, middle.y + arrow}, IM_COL32(30, 36, 44, 255));
}

}  // namespace tessera
