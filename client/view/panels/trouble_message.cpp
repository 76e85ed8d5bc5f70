#include <algorithm>
#include <string>

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

struct Trouble {
    const char* heading = "";
    std::string words{};
};

/// Why hands do not show all that they hold; no words: they do.
Trouble trouble_of_hands(const PanelContents& contents) {
    Trouble trouble{"Not all that is held is seen"};
    if (const std::size_t undrawn = contents.plane.held_patterns().undrawn(); undrawn > 0)
        trouble.words = std::to_string(undrawn) + (undrawn == 1 ? " sprite is" : " sprites are") +
                        " not drawn, or not everywhere, until let go. There is room for " +
                        std::to_string(HeldSprites::most_sprites) + ", for " +
                        std::to_string(HeldMap::most_layers) +
                        " over each other, and for as many patterns as the driver keeps.";
    if (contents.frame.unlifted_holds.empty()) return trouble;
    if (!trouble.words.empty()) trouble.words += ' ';
    trouble.words += "A change touches more pages than can be kept beside: it is seen once they have come.";
    return trouble;
}

Trouble trouble_of(const PanelContents& contents) {
    // A lost stream is the cause of what its requests say
    if (!contents.source.trouble.empty()) return {"No connection", contents.source.trouble};
    // That pages ended with a connection says nothing once there is another
    const std::string& problem = contents.plane.residency().requests().problem();
    if (!problem.empty() && problem != contents.source.last_loss)
        return {"Pages do not come; trying again", problem};
    return trouble_of_hands(contents);
}

}  // namespace

void trouble_message(const PanelContents& contents) {
    const auto [heading, words] = trouble_of(contents);
    if (words.empty()) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float margin = 12 * contents.scale;
    ImGui::SetNextWindowPos({screen.x - margin, screen.y - margin - contents.room.below_corner},
                            ImGuiCond_Always, {1, 1});
    ImGui::Begin("trouble", nullptr, message_flags);
    ImGui::PushTextWrapPos(message_width(contents.scale));
    wrapped(panel_colours::bad, heading);
    ImGui::TextWrapped("%s", words.c_str());
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
