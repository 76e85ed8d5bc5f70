#include "client/view/panels/panel_columns.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr float margin = 12, gap = 6, width_left = 300, width_right = 280;
constexpr float least_open = 44;  // of a panel's inside: less is folded

}  // namespace

PanelColumns::PanelColumns(float scale, const PanelRoom& room)
    : scale_{scale},
      bottom_{room.below_left, room.below_right},
      screen_{ImGui::GetIO().DisplaySize},
      next_y_{margin * scale, margin * scale} {}

float PanelColumns::reach(Side side, float scale) {
    const float width = (side == Side::left ? width_left : width_right) * scale;
    return std::min(width + margin * scale, ImGui::GetIO().DisplaySize.x / 2 - margin * scale / 2);
}

bool PanelColumns::begin(Side side, const char* title, bool open_at_first) {
    side_ = side;
    const bool left = side == Side::left;
    // Two columns never meet
    const float width = reach(side, scale_) - margin * scale_;
    const float y = next_y_[left ? 0 : 1];
    const float x = left ? margin * scale_ : screen_.x - margin * scale_ - width;
    int& to_come = left_to_come_[left ? 0 : 1];
    if (to_come > 0) --to_come;
    const float below = static_cast<float>(to_come) * (ImGui::GetFrameHeight() + gap * scale_);
    const float room =
        std::max(screen_.y - bottom_[left ? 0 : 1] - margin * scale_ - y - below, ImGui::GetFrameHeight());
    ImGui::SetNextWindowPos({x, y}, ImGuiCond_Always);
    ImGui::SetNextWindowSizeConstraints({width, 0}, {width, room});
    ImGui::SetNextWindowCollapsed(!open_at_first, ImGuiCond_Once);
    // Sizes are known after some frames
    if (ImGui::GetFrameCount() > 4 && room < ImGui::GetFrameHeight() + least_open * scale_)
        ImGui::SetNextWindowCollapsed(true, ImGuiCond_Always);
    return ImGui::Begin(title, nullptr,
                        ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav |
                            ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
                            ImGuiWindowFlags_NoSavedSettings);
}

void PanelColumns::end() {
    next_y_[side_ == Side::left ? 0 : 1] += ImGui::GetWindowHeight() + gap * scale_;
    ImGui::End();
}

bool begin_rows(const char* id, float scale) {
    if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingStretchProp)) return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 84 * scale);
    ImGui::TableSetupColumn("value");
    return true;
}

void wrapped(const ImVec4& colour, const std::string& words) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextWrapped("%s", words.c_str());
    ImGui::PopStyleColor();
}

void row(const char* name, const std::string& value, const ImVec4& colour) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(panel_colours::quiet, "%s", name);
    ImGui::TableNextColumn();
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextWrapped("%s", value.c_str());
    ImGui::PopStyleColor();
}

std::string grouped(long long number) {
    std::string digits = std::to_string(number);
    for (auto at = static_cast<int>(digits.size()) - 3; at > (number < 0 ? 1 : 0); at -= 3)
        digits.insert(static_cast<std::size_t>(at), " ");
    return digits;
}

}  // namespace tessera
