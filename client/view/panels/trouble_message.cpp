#include <algorithm>

#include "client/view/panels/panels.h"

namespace tessera {
namespace {

constexpr ImGuiWindowFlags message_flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                           ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                                           ImGuiWindowFlags_NoSavedSettings;

/// Where a message's lines end, in its window: it never is wider than the program's.
float message_width(float scale) {
    return std::max(80.0F, std::min(360 * scale, ImGui::GetIO().DisplaySize.x - 48 * scale));
}

}  // namespace

void trouble_message(const PanelContents& contents) {
    // A lost stream is the cause of what its requests say
    const std::string& trouble = contents.source.trouble;
    const std::string& problem = trouble.empty() ? contents.plane.residency().requests().problem() : trouble;
    // That pages ended with a connection says nothing once there is another
    if (problem.empty() || (trouble.empty() && problem == contents.source.last_loss)) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float margin = 12 * contents.scale;
    ImGui::SetNextWindowPos({screen.x - margin, screen.y - margin - contents.room.below_corner},
                            ImGuiCond_Always, {1, 1});
    ImGui::Begin("trouble", nullptr, message_flags);
    ImGui::PushTextWrapPos(message_width(contents.scale));
    wrapped(panel_colours::bad, trouble.empty() ? "Pages do not come; trying again" : "No connection");
    ImGui::TextWrapped("%s", problem.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

void notice_message(const PanelContents& contents) {
    if (contents.notice.words.empty()) return;
    const float top = 60 * contents.scale;  // below the editor's bar
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x / 2, top}, ImGuiCond_Always, {0.5F, 0});
    ImGui::Begin("notice", nullptr, message_flags);
    ImGui::PushTextWrapPos(message_width(contents.scale));
    wrapped(contents.notice.is_good ? panel_colours::good : panel_colours::bad, contents.notice.words);
    ImGui::PopTextWrapPos();
    ImGui::End();
}

}  // namespace tessera
