#include "client/view/hand_panel.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <imgui.h>

#include "client/view/hand_input.h"
#include "client/view/hand_overlay.h"
#include "client/view/panels/panel_columns.h"

namespace tessera {
namespace {

constexpr ImGuiWindowFlags bar_flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                       ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav |
                                       ImGuiWindowFlags_NoFocusOnAppearing |
                                       ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings;
const ImVec4 amber{0.95F, 0.76F, 0.47F, 1};

void tip(const char* words) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", words);
}

/// A button that stays down while it is chosen.
bool choice(const char* name, bool is_chosen, const char* words) {
    if (is_chosen) {
        ImGui::PushStyleColor(ImGuiCol_Button, {0.36F, 0.27F, 0.12F, 1});
        ImGui::PushStyleColor(ImGuiCol_Text, amber);
    }
    const bool clicked = ImGui::Button(name);
    if (is_chosen) ImGui::PopStyleColor(2);
    tip(words);
    return clicked;
}

bool button(const char* name, bool is_enabled, const char* words) {
    ImGui::BeginDisabled(!is_enabled);
    const bool clicked = ImGui::Button(name);
    ImGui::EndDisabled();
    tip(words);
    return clicked && is_enabled;
}

/// To some 24 letters.
std::string shortened(std::string name) {
    constexpr std::size_t most = 24;
    if (name.size() <= most) return name;
    std::size_t end = most;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // within a letter
    return name.substr(0, end) + "...";
}

std::string hint(const HandDesk& desk) {
    const Hand& hand = desk.hand();
    if (!desk.may_edit()) return "Looking only: " + desk.why_not();
    if (desk.tool == HandDesk::Tool::brush) return "Drag to paint; [ and ] change the radius.";
    if (desk.tool == HandDesk::Tool::target) return "Drag a target; what looks at it follows.";
    if (hand.book().is_partial()) return "Many sprites: come closer to take hold of them.";
    if (hand.placing()) return "Click to place; Escape ends.";
    if (hand.selected().size() > 1) return "Drag to move all; corners scale, the knob turns.";
    if (!hand.selected().empty()) return "Drag to move; corners scale, the knob turns.";
    return "Pick a pattern to place, or take hold of a sprite. Shift frames several.";
}

}  // namespace

GLuint HandPanel::texture_of(std::int32_t pattern) {
    const Rgba8Image* image = desk_.picture(pattern);
    if (!image) {
        desk_.want_picture(pattern);
        return 0;
    }
    Picture& picture = pictures_[pattern];
    if (picture.texture.name() == 0 || picture.made_of != image) {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &name);
        picture.texture = GlTexture{name};
        picture.made_of = image;
        glTextureStorage2D(name, 1, GL_RGBA8, image->width, image->height);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glTextureSubImage2D(name, 0, 0, 0, image->width, image->height, GL_RGBA, GL_UNSIGNED_BYTE,
                            image->bytes.data());
        glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    return picture.texture.name();
}

PanelRoom HandPanel::draw(const HandPicture& picture, float scale, float pixels_per_unit) {
    on_picture(picture, scale, pixels_per_unit);
    tools_ = selection_ = {};
    if (desk_.is_open) bars(scale);
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    PanelRoom room;
    for (const Bar& bar : {tools_, selection_}) {
        if (bar.is_above) continue;
        const auto free = [&](float& below, bool is_met) {
            if (is_met) below = std::max(below, bar.from_below + bar.height);
        };
        free(room.below_left, bar.left < PanelColumns::reach(PanelColumns::Side::left, scale));
        free(room.below_right, bar.right > screen.x - PanelColumns::reach(PanelColumns::Side::right, scale));
        free(room.below_corner, bar.right > screen.x - 400 * scale);
    }
    others_news(scale, room.below_corner);
    if (news_height_ > 0) room.below_corner += news_height_ + 6 * scale;
    return room;
}

void HandPanel::bars(float scale) {
    ImGui::PushStyleColor(ImGuiCol_Button, {0.17F, 0.20F, 0.245F, 1});
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, {0.26F, 0.31F, 0.37F, 1});
    ImGui::PushStyleColor(ImGuiCol_ButtonActive, {0.36F, 0.27F, 0.12F, 1});
    ImGui::PushStyleColor(ImGuiCol_SliderGrab, amber);
    ImGui::PushStyleColor(ImGuiCol_SliderGrabActive, amber);
    tool_bar(scale);
    selection_bar(scale);
    ImGui::PopStyleColor(5);
}

/// Of the window that is being made.
HandPanel::Bar HandPanel::bar_here(float from_below) {
    const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    return {at.x, at.x + size.x, size.y, from_below, false};
}

/// In this line as far as there is room, else in lines of its own.
void HandPanel::words(const ImVec4& colour, const std::string& text, float scale) {
    const float end = ImGui::GetIO().DisplaySize.x - 64 * scale;
    const float begin = ImGui::GetCursorScreenPos().x - ImGui::GetWindowPos().x;
    if (begin + ImGui::CalcTextSize(text.c_str()).x > end) ImGui::NewLine();
    ImGui::PushTextWrapPos(end);
    wrapped(colour, text);
    ImGui::PopTextWrapPos();
}

void HandPanel::tool_bar(float scale) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x / 2, screen.y - 12 * scale}, ImGuiCond_Always, {0.5F, 1});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(300.0F, screen.x - 40 * scale), screen.y / 2});
    ImGui::Begin("editor", nullptr, bar_flags);
    const bool may = desk_.may_edit();
    if (desk_.pattern_count() > 0 &&
        choice("Hand", desk_.tool == HandDesk::Tool::hand && !desk_.hand().placing(),
               "Select and move (V)")) {
        desk_.tool = HandDesk::Tool::hand;
        desk_.hand().choose(std::nullopt);
    }
    if (!desk_.brushes().empty()) {
        ImGui::SameLine();
        if (choice("Brush", desk_.tool == HandDesk::Tool::brush, "Paint a map")) {
            desk_.tool = HandDesk::Tool::brush;
            desk_.hand().choose(std::nullopt);
        }
    }
    if (!desk_.targets().targets().empty()) {
        ImGui::SameLine();
        if (choice("Targets", desk_.tool == HandDesk::Tool::target, "Drag what animations look at")) {
            desk_.tool = HandDesk::Tool::target;
            desk_.hand().choose(std::nullopt);
        }
    }
    ImGui::SameLine(0, 18 * scale);
    if (button("Undo", may && desk_.edits().history().can_undo(), "Ctrl+Z")) desk_.undo();
    ImGui::SameLine();
    if (button("Redo", may && desk_.edits().history().can_redo(), "Ctrl+Shift+Z")) desk_.redo();
    ImGui::SameLine(0, 18 * scale);
    ImGui::AlignTextToFramePadding();
    if (!desk_.message().empty())
        words(panel_colours::bad, desk_.message(), scale);
    else if (desk_.edits().waiting() > 0 && !may)
        words(panel_colours::waiting,
              std::to_string(desk_.edits().waiting()) + " not saved yet: " + desk_.why_not(), scale);
    else if (const std::string outside = why_not_paint(desk_); may && !outside.empty())
        words(panel_colours::waiting, outside, scale);
    else
        words(panel_colours::quiet, hint(desk_), scale);
    switch (desk_.tool) {
        case HandDesk::Tool::hand:
            palette(scale);
            break;
        case HandDesk::Tool::brush:
            brush_tools(scale);
            break;
        case HandDesk::Tool::target:
            target_tools();
            break;
    }
    for (HandDesk::Density& density : desk_.densities()) {
        auto value = static_cast<float>(std::clamp(density.density, 0.05, 64.0));
        ImGui::SetNextItemWidth(220 * scale);
        ImGui::SliderFloat(("##" + density.block).c_str(), &value, 0.05F, 64, "%.2f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
        if (ImGui::IsItemActive()) density.density = static_cast<double>(value);
        if (ImGui::IsItemDeactivatedAfterEdit()) desk_.set_density(density);
        ImGui::SameLine();
        ImGui::TextColored(panel_colours::quiet, "%s: rests between, more is rarer", density.block.c_str());
    }
    tools_ = bar_here(12 * scale);
    ImGui::End();
}

void HandPanel::palette(float scale) {
    if (desk_.pattern_count() == 0) return;
    const float side = 52 * scale;
    const float room = std::min(ImGui::GetIO().DisplaySize.x - 80 * scale, 14 * (side + 6 * scale));
    const int columns = std::max(1, static_cast<int>(room / (side + 6 * scale)));
    const int rows = (desk_.pattern_count() + columns - 1) / columns;
    const auto width =
        static_cast<float>(std::min(columns, static_cast<int>(desk_.pattern_count()))) * (side + 6 * scale);
    ImGui::BeginChild("patterns", {width + (rows > 2 ? 14 * scale : 0),
                                   static_cast<float>(std::min(rows, 2)) * (side + 6 * scale)});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {6 * scale, 6 * scale});
    ImDrawList* list = ImGui::GetWindowDrawList();
    for (std::int32_t pattern = 0; pattern < desk_.pattern_count(); ++pattern) {
        if (pattern % columns != 0) ImGui::SameLine();
        ImGui::PushID(pattern);
        const ImVec2 low = ImGui::GetCursorScreenPos(), high{low.x + side, low.y + side};
        const bool clicked = ImGui::InvisibleButton("pattern", {side, side});
        const bool is_chosen = desk_.hand().placing() == pattern, is_hovered = ImGui::IsItemHovered();
        if (ImGui::IsItemVisible()) {
            list->AddRectFilled(low, high,
                                is_hovered ? IM_COL32(134, 143, 154, 255) : IM_COL32(104, 112, 123, 255),
                                6 * scale);
            const float inset = 5 * scale;
            if (const GLuint texture = texture_of(pattern))
                list->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                               {low.x + inset, low.y + inset}, {high.x - inset, high.y - inset});
            if (is_chosen)
                list->AddRect(low, high, ImGui::ColorConvertFloat4ToU32(amber), 6 * scale, 0, 2 * scale);
        }
        std::string words = desk_.pattern_name(pattern);
        if (pattern < 9) words += "  (" + std::to_string(pattern + 1) + ")";
        tip(words.c_str());
        if (clicked) desk_.hand().choose(is_chosen ? std::nullopt : std::optional{pattern});
        ImGui::PopID();
    }
    ImGui::PopStyleVar();
    ImGui::EndChild();
}

void HandPanel::brush_tools(float scale) {
    std::vector<MapBrush>& brushes = desk_.brushes();
    MapBrush* brush = desk_.brush();
    if (!brush) return;
    if (brushes.size() > 1) {
        ImGui::SetNextItemWidth(160 * scale);
        if (ImGui::BeginCombo("map", brush->grid().block().c_str())) {
            for (std::size_t i = 0; i < brushes.size(); ++i)
                if (ImGui::Selectable(brushes[i].grid().block().c_str(), i == desk_.brush_index()))
                    desk_.choose_brush(i);
            ImGui::EndCombo();
        }
        brush = desk_.brush();
        ImGui::SameLine();
    } else {
        ImGui::AlignTextToFramePadding();
        ImGui::TextColored(panel_colours::quiet, "%s", brush->grid().block().c_str());
        ImGui::SameLine();
    }
    const std::int32_t least = brush->grid().least(), most = brush->grid().most();
    if (most - least < 12) {
        for (std::int32_t value = least; value <= most; ++value) {
            if (value != least) ImGui::SameLine();
            const ImVec4 hue = value_colour(value);
            ImGui::PushID(value);
            ImGui::PushStyleColor(ImGuiCol_Button, {hue.x * 0.55F, hue.y * 0.55F, hue.z * 0.55F, 1});
            ImGui::PushStyleColor(ImGuiCol_Border, amber);
            ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, value == brush->value ? 2 * scale : 0);
            if (ImGui::Button(std::to_string(value).c_str(), {30 * scale, 0})) brush->value = value;
            ImGui::PopStyleVar();
            ImGui::PopStyleColor(2);
            ImGui::PopID();
        }
    } else {
        ImGui::SetNextItemWidth(160 * scale);
        ImGui::SliderInt("entry", &brush->value, least, most);
    }
    ImGui::SameLine(0, 18 * scale);
    const auto entry = static_cast<float>(brush->grid().entry_texels());
    auto radius = static_cast<float>(brush->radius_texels);
    ImGui::SetNextItemWidth(200 * scale);
    if (ImGui::SliderFloat("radius", &radius, entry / 2, 40 * entry, "%.0f texels",
                           ImGuiSliderFlags_Logarithmic))
        brush->radius_texels = static_cast<double>(radius);
}

void HandPanel::target_tools() {
    for (const proto::Target& target : desk_.targets().targets())
        ImGui::TextColored(panel_colours::quiet, "target %llu at %s, %s%s",
                           static_cast<unsigned long long>(target.id()), grouped(target.x()).c_str(),
                           grouped(target.y()).c_str(), target.legs().empty() ? "" : ", on its way");
}

void HandPanel::selection_bar(float scale) {
    const std::vector<HandSprite> selection = desk_.hand().selection();
    if (selection.empty() || desk_.tool != HandDesk::Tool::hand) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    // Beside the panels if there is room, else above the tools
    const bool is_above =
        selection_width_ / 2 < screen.x / 2 - PanelColumns::reach(PanelColumns::Side::left, scale);
    const float from_below = tools_.height + 18 * scale;
    ImGui::SetNextWindowPos({screen.x / 2, is_above ? 12 * scale : screen.y - from_below}, ImGuiCond_Always,
                            {0.5F, is_above ? 0.0F : 1.0F});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(300.0F, screen.x - 24 * scale), screen.y / 2});
    ImGui::Begin("selection", nullptr, bar_flags);
    selection_width_ = ImGui::GetWindowWidth();
    if (!is_above) selection_ = bar_here(from_below);
    const HandSprite& first = selection.front();
    ImGui::AlignTextToFramePadding();
    if (selection.size() == 1)
        ImGui::TextUnformatted(shortened(desk_.pattern_name(first.pattern)).c_str());
    else
        ImGui::Text("%zu sprites", selection.size());
    ImGui::SameLine(0, 14 * scale);
    const auto slider = [&](const char* name, double now, float least, float most, const char* format,
                            ImGuiSliderFlags flags, auto preview) {
        auto value = static_cast<float>(now);
        ImGui::SetNextItemWidth(130 * scale);
        if (ImGui::SliderFloat(name, &value, least, most, format, flags | ImGuiSliderFlags_AlwaysClamp))
            preview(static_cast<double>(value));
        if (ImGui::IsItemDeactivatedAfterEdit()) desk_.hand().put_preview();
    };
    slider("##scale", first.scale / double{sprite_scale_one}, 1.0F / 64, 4, "\xc3\x97 %.3f",
           ImGuiSliderFlags_Logarithmic, [&](double scaled) { desk_.hand().preview_scale(scaled); });
    tip("Scale; Ctrl+click to type");
    ImGui::SameLine();
    slider("##turn", first.turn * 360 / 65536.0, 0, 360, "%.1f\xc2\xb0", ImGuiSliderFlags_None,
           [&](double degrees) { desk_.hand().preview_turns(degrees / 360); });
    tip("Turn (R); Ctrl+click to type");
    ImGui::SameLine(0, 14 * scale);
    if (button("Front", true, "In front of all (Page up)")) desk_.hand().raise(true);
    ImGui::SameLine();
    if (button("Back", true, "Behind all (Page down)")) desk_.hand().raise(false);
    ImGui::SameLine();
    if (button("Duplicate", true, "Ctrl+D")) desk_.hand().duplicate();
    ImGui::SameLine();
    if (button("Delete", true, "Delete")) desk_.hand().remove();
    ImGui::End();
}

/// What others did in the last seconds.
void HandPanel::others_news(float scale, float from_below) {
    news_height_ = 0;
    constexpr ClientTime shown_for{5000};
    const ClientTime now = desk_.hand().view().now;
    if (desk_.news().empty() || now - desk_.news().front().at > shown_for) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x - 12 * scale, screen.y - 12 * scale - from_below}, ImGuiCond_Always,
                            {1, 1});
    ImGui::Begin("news", nullptr, bar_flags | ImGuiWindowFlags_NoInputs);
    int count = 0;
    for (const HandDesk::News& news : desk_.news()) {
        if (now - news.at > shown_for || ++count > 4) break;
        ImGui::TextColored({news.red, news.green, news.blue, 1}, "%s", shortened(news.who).c_str());
        ImGui::SameLine();
        ImGui::TextColored(panel_colours::quiet, "%s", shortened(news.what).c_str());
    }
    news_height_ = ImGui::GetWindowHeight();
    ImGui::End();
}

void HandPanel::on_picture(const HandPicture& picture, float scale, float pixels_per_unit) {
    for (int sheet = 0; sheet < picture.sheets(); ++sheet) {
        HandOverlay overlay{*ImGui::GetBackgroundDrawList(), picture, scale, pixels_per_unit, sheet};
        if (desk_.is_open) {
            overlay.brush(desk_);
            overlay.targets(desk_);
            overlay.selection(desk_);
        }
        overlay.people(desk_);
    }
}

}  // namespace tessera
