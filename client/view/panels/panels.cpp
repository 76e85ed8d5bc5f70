#include "client/view/panels/panels.h"

#include <filesystem>

namespace tessera {

void style_panels(float content_scale) {
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // panels have fixed places: nothing to remember
    const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    std::error_code ignored;
    io.Fonts->Clear();
    if (std::filesystem::exists(font, ignored))
        io.Fonts->AddFontFromFileTTF(font, 13 * content_scale);
    else
        io.FontGlobalScale = content_scale;
    ImGui::GetStyle() = {};
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 8;
    style.FrameRounding = style.GrabRounding = 4;
    style.WindowPadding = {12, 9};
    style.FramePadding = {6, 4};
    style.ItemSpacing = {8, 5};
    style.CellPadding = {4, 1.5F};
    style.WindowBorderSize = 0;
    style.WindowTitleAlign = {0, 0.5F};
    style.ScrollbarSize = 10;
    ImVec4* colours = style.Colors;
    colours[ImGuiCol_WindowBg] = {0.055F, 0.067F, 0.082F, 0.88F};
    colours[ImGuiCol_TitleBg] = colours[ImGuiCol_TitleBgActive] = {0.09F, 0.115F, 0.145F, 0.95F};
    colours[ImGuiCol_TitleBgCollapsed] = {0.07F, 0.085F, 0.105F, 0.80F};
    colours[ImGuiCol_FrameBg] = {0.16F, 0.19F, 0.23F, 1};
    colours[ImGuiCol_CheckMark] = colours[ImGuiCol_PlotLines] = colours[ImGuiCol_SliderGrab] =
        panel_colours::accent;
    colours[ImGuiCol_Separator] = {0.22F, 0.26F, 0.31F, 1};
    style.ScaleAllSizes(content_scale);
}

void draw_panels(const PanelContents& contents, ViewerSwitches& switches) {
    if (switches.panel) {
        PanelColumns columns{contents.scale, contents.room};
        columns.expect(PanelColumns::Side::left, 7);
        scene_panel(columns, contents);
        read_out_panel(columns, contents);
        filter_panel(columns, contents, switches);
        view_panel(columns, contents, switches);
        overlay_panel(columns, contents, switches);
        pages_panel(columns, contents, switches);
        frames_panel(columns, contents, switches);
        if (switches.metrics) metrics_overlay(columns, contents);
    }
    split_labels(contents, switches);
    trouble_message(contents);
    notice_message(contents);
    if (switches.help) help_overlay(contents.scale, switches);
}

}  // namespace tessera
