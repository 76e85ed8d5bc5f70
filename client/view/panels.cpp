#include "client/view/panels.h"

#include <algorithm>
#include <filesystem>
#include <string>

#include <imgui.h>

namespace tessera {
namespace {

const ImVec4 quiet{0.62F, 0.67F, 0.73F, 1}, accent{0.45F, 0.78F, 0.98F, 1}, good{0.50F, 0.86F, 0.60F, 1},
    waiting{0.98F, 0.80F, 0.40F, 1}, bad{1.0F, 0.50F, 0.44F, 1};

/// 1234567 -> "1 234 567": long coordinates can be read.
std::string grouped(std::int64_t number) {
    std::string digits = std::to_string(number);
    for (auto at = static_cast<int>(digits.size()) - 3; at > (number < 0 ? 1 : 0); at -= 3)
        digits.insert(static_cast<std::size_t>(at), " ");
    return digits;
}

void row(const char* name, const std::string& value, const ImVec4& colour = {0.92F, 0.94F, 0.96F, 1}) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(quiet, "%s", name);
    ImGui::TableNextColumn();
    ImGui::TextColored(colour, "%s", value.c_str());
}

std::string text(const char* format, auto... values) {
    char buffer[128];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

bool begin_rows(const char* id, float scale) {
    if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingStretchProp)) return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 92 * scale);
    ImGui::TableSetupColumn("value");
    return true;
}

void heading(const char* name) {
    ImGui::Dummy({0, 4});
    ImGui::TextColored(accent, "%s", name);
    ImGui::Separator();
}

void cursor_rows(const PanelContents& contents) {
    if (!begin_rows("cursor", contents.scale)) return;
    if (const auto& reading = contents.cursor) {
        row("texel", grouped(reading->texel.x) + ", " + grouped(reading->texel.y));
        row("level", text("%.2f of %d", reading->level, int{contents.scene.extent.n}));
        row("page", grouped(reading->page.x) + ", " + grouped(reading->page.y));
        const bool sharp = reading->shown && reading->shown->level == reading->page.level;
        row("shows", page_state(*reading), sharp ? good : waiting);
    } else {
        row("texel", "-");
        row("level", "-");
        row("page", "-");
        row("shows", "-");
    }
    ImGui::EndTable();
}

void camera_rows(const PanelContents& contents) {
    if (!begin_rows("camera", contents.scale)) return;
    const Camera& camera = contents.view.camera();
    row("above", grouped(camera.ground.x) + ", " + grouped(camera.ground.y));
    row("height", camera.height_texels < 1e6 ? text("%.1f texels", camera.height_texels)
                                             : text("%.4g texels", camera.height_texels));
    const double yaw = camera.yaw_degrees < 0 ? camera.yaw_degrees + 360 : camera.yaw_degrees;
    row("heading", text("%.0f\xc2\xb0, pitch %.0f\xc2\xb0", yaw, camera.pitch_degrees));
    ImGui::EndTable();
}

void page_rows(const PanelContents& contents) {
    const ResidencyFrame& frame = contents.frame;
    const Residency& residency = contents.plane.residency();
    const RequestCounts& counts = residency.requests().counts();
    ImGui::PushStyleColor(ImGuiCol_PlotHistogram, frame.is_sharp() ? good : waiting);
    ImGui::ProgressBar(static_cast<float>(frame.resident_share), {-1, 6 * contents.scale}, "");
    ImGui::PopStyleColor();
    if (!begin_rows("pages", contents.scale)) return;
    row("sharp", text("%.0f %% of the plane", 100 * frame.resident_share), frame.is_sharp() ? good : waiting);
    row("missing", text("%zu of %zu pages, %.2f levels", frame.missing, frame.needed, frame.mip_deficit));
    row("cache", text("%zu of %zu, %.0f MB", residency.cache().size(), residency.cache().capacity(),
                      static_cast<double>(contents.plane.gpu_bytes()) / 1e6));
    row("evicted", grouped(static_cast<std::int64_t>(residency.cache().evictions())));
    row("in flight",
        text("%zu of %zu", residency.requests().in_flight(), residency.settings().requests.in_flight));
    row("requests",
        text("%llu, %llu cancelled, %llu failed", static_cast<unsigned long long>(counts.requested),
             static_cast<unsigned long long>(counts.cancelled),
             static_cast<unsigned long long>(counts.failed)));
    if (frame.stale > 0) row("changed", text("%zu shown as they were before", frame.stale), waiting);
    row("received", text("%.1f MB", static_cast<double>(contents.bytes_received) / 1e6));
    if (frame.lod_bias > 0) row("blurred", text("by %.2f levels: small cache", frame.lod_bias), waiting);
    ImGui::EndTable();
}

void live_rows(const PanelContents& contents) {
    const ViewSource::State& source = contents.source;
    if (!begin_rows("live", contents.scale)) return;
    row("revision", grouped(static_cast<std::int64_t>(source.revision)));
    row("step", grouped(contents.step));
    row("others here", std::to_string(source.others));
    row("round trip", text("%.1f ms", source.round_trip_ms));
    ImGui::EndTable();
}

void filter_rows(ViewerSwitches& switches) {
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
}

void info_panel(const PanelContents& contents, ViewerSwitches& switches) {
    const float margin = 12 * contents.scale;
    ImGui::SetNextWindowPos({margin, margin}, ImGuiCond_Always);
    ImGui::SetNextWindowSize({320 * contents.scale, 0}, ImGuiCond_Always);
    ImGui::Begin("info", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
    const std::string& title = contents.scene.title.empty() ? contents.scene.id : contents.scene.title;
    ImGui::TextUnformatted(title.c_str());
    ImGui::TextColored(quiet, "%s on %s", contents.scene.id.c_str(), contents.server.c_str());
    heading("Under the cursor");
    cursor_rows(contents);
    heading("Camera");
    camera_rows(contents);
    heading("Pages");
    page_rows(contents);
    if (contents.source.is_live) {
        heading("Live");
        live_rows(contents);
    }
    heading("Filter");
    filter_rows(switches);
    heading("Frames");
    const double mean = contents.times.mean_milliseconds();
    ImGui::Text("%.0f per second, %.1f ms", mean > 0 ? 1000 / mean : 0, mean);
    ImGui::PlotLines("##times", contents.times.values().data(),
                     static_cast<int>(contents.times.values().size()), contents.times.oldest(), nullptr, 0,
                     static_cast<float>(std::max(33.0, 2 * mean)),
                     {ImGui::GetContentRegionAvail().x, 34 * contents.scale});
    ImGui::Checkbox("page borders", &switches.page_borders);
    ImGui::SameLine(150 * contents.scale);
    ImGui::Checkbox("haze", &switches.haze);
    ImGui::Checkbox("fade in", &switches.fade);
    ImGui::SameLine(150 * contents.scale);
    ImGui::Checkbox("vsync", &switches.vsync);
    ImGui::Dummy({0, 2});
    if (!contents.scene.attribution.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, quiet);
        ImGui::TextWrapped("%s", contents.scene.attribution.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::TextColored(quiet, "H: keys   Tab: hide this panel");
    ImGui::End();
}

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
    ImGui::TextColored(bad, trouble.empty() ? "Pages do not come; trying again" : "No connection");
    ImGui::PushTextWrapPos(360 * contents.scale);
    ImGui::TextWrapped("%s", problem.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

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
        {"B", "page borders, coloured by level"},
        {"P", "screenshot; with Shift the panels too"},
        {"K", "print the camera as a key of a camera path"},
        {"Tab", "hide or show the panel"},
        {"F11", "full screen"},
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
            ImGui::TextColored(accent, "%s", key);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace

void style_panels(float content_scale) {
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // panels have fixed places: nothing to remember
    const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    std::error_code ignored;
    if (std::filesystem::exists(font, ignored))
        io.Fonts->AddFontFromFileTTF(font, 14 * content_scale);
    else
        io.FontGlobalScale = content_scale;
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 8;
    style.FrameRounding = 4;
    style.WindowPadding = {14, 12};
    style.ItemSpacing = {8, 5};
    style.CellPadding = {4, 2};
    style.WindowBorderSize = 0;
    style.Colors[ImGuiCol_WindowBg] = {0.055F, 0.067F, 0.082F, 0.86F};
    style.Colors[ImGuiCol_TitleBgActive] = style.Colors[ImGuiCol_TitleBg] = {0.09F, 0.12F, 0.16F, 1};
    style.Colors[ImGuiCol_FrameBg] = {0.16F, 0.19F, 0.23F, 1};
    style.Colors[ImGuiCol_CheckMark] = style.Colors[ImGuiCol_PlotLines] = accent;
    style.Colors[ImGuiCol_Separator] = {0.22F, 0.26F, 0.31F, 1};
    style.ScaleAllSizes(content_scale);
}

void draw_panels(const PanelContents& contents, ViewerSwitches& switches) {
    if (switches.panel) info_panel(contents, switches);
    trouble_message(contents);
    if (switches.help) help_overlay(contents.scale, switches);
}

}  // namespace tessera
