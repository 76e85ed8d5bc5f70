#include "client/view/panels/panels.h"

namespace tessera {

void help_overlay(float scale, ViewerSwitches& switches) {
    static constexpr const char* keys[][2] = {
        {"drag", "move the plane"},
        {"right drag", "turn the head"},
        {"middle drag, Ctrl + drag", "orbit the middle of the picture"},
        {"wheel, + and -", "zoom to the cursor"},
        {"W A S D, arrows", "fly; with Shift faster"},
        {"Q, E", "sink, rise"},
        {"T", "look straight down"},
        {"Home", "back to the beginning"},
        {"F, 1 to 7", "next filter (Shift: last one); this one"},
        {"V", "next surface: plane, terrain, corridor (Shift: last)"},
        {"O", "a drag orbits, instead of moving the plane"},
        {"B", "next overlay: page borders, age, revision"},
        {"X", "side by side; drag the line between"},
        {"P", "screenshot; with Shift the panels too"},
        {"K", "print the camera as a key of a camera path"},
        {"R", "record the camera's way into a file; again: stop"},
        {"L", "play it, or the path of --camera; again: stop"},
        {"M", "figures of the session"},
        {"Tab", "hide or show the panels"},
        {"F11", "full screen"},
        {"Enter", "edit the scene, or stop to"},
        {"  drag, click, Shift", "move a sprite, select it, select several"},
        {"  corners, knob", "scale; turn (Shift: by 15 degrees)"},
        {"  1 to 9, V", "a pattern to place; back to the hand"},
        {"  Del, Ctrl+D, Ctrl+A", "delete, duplicate, select all"},
        {"  R, arrows, Page up/down", "turn, nudge, in front or behind"},
        {"  Ctrl+Z, Ctrl+Shift+Z", "undo, redo"},
        {"  [ and ]", "the brush's radius"},
        {"H, F1", "this help"},
        {"Esc", "close this, then the window"},
    };
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::Begin("Keys", &switches.help,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2)) {
        ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, 190 * scale);
        ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthFixed, 320 * scale);
        for (const auto& [key, what] : keys) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored(panel_colours::accent, "%s", key);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace tessera
