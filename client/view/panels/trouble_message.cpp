#include <algorithm>

#include "client/view/panels/panels.h"

namespace tessera {

void trouble_message(const PanelContents& contents) {
    // A lost stream is the cause of what its requests say
    const std::string& trouble = contents.source.trouble;
    const std::string& problem = trouble.empty() ? contents.plane.residency().requests().problem() : trouble;
    if (problem.empty()) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float margin = 12 * contents.scale;
    ImGui::SetNextWindowPos({screen.x - margin, screen.y - margin}, ImGuiCond_Always, {1, 1});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(200.0F, screen.x / 2), screen.y});
    ImGui::Begin("trouble", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::TextColored(panel_colours::bad, "%s",
                       trouble.empty() ? "Pages do not come; trying again" : "No connection");
    ImGui::PushTextWrapPos(360 * contents.scale);
    ImGui::TextWrapped("%s", problem.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

}  // namespace tessera
