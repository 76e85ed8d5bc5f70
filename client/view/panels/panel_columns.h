#pragma once

#include <string>

#include <imgui.h>

namespace tessera {

/// Colours of words in panels.
namespace panel_colours {
inline const ImVec4 plain{0.92F, 0.94F, 0.96F, 1}, quiet{0.62F, 0.67F, 0.73F, 1},
    accent{0.45F, 0.78F, 0.98F, 1}, good{0.50F, 0.86F, 0.60F, 1}, waiting{0.98F, 0.80F, 0.40F, 1},
    bad{1.0F, 0.50F, 0.44F, 1};
}

/// What is kept free of panels at the window's bottom, in ImGui's units from its edge: the editor's bars may
/// stand there.
struct PanelRoom {
    float below_left = 0, below_right = 0;  ///< Under the columns
    float below_corner = 0;                 ///< Under messages in the right corner
};

/// Stacks panels in two columns at the window's sides: each below the one before, none wider than its column,
/// none below the window's edge (it scrolls instead). A click on a title folds its panel. One for each frame.
class PanelColumns {
  public:
    enum class Side { left, right };

    /// `scale`: the screen's content scale.
    explicit PanelColumns(float scale, const PanelRoom& room = {});

    /// Where a column ends: so far from its side of the window.
    static float reach(Side side, float scale);

    /// So many panels will stand in a column: those above leave room for the titles of those below.
    void expect(Side side, int panels) { left_to_come_[side == Side::left ? 0 : 1] = panels; }

    /// Opens the next panel of a column. False if it is folded: nothing is to be put in then. end() follows
    /// either way. `open_at_first`: how it stands until someone folds or unfolds it.
    bool begin(Side side, const char* title, bool open_at_first = true);
    void end();

    float scale() const { return scale_; }
    /// Whether the window is too low for all panels to stand open.
    bool is_low() const { return screen_.y < 700 * scale_; }

  private:
    float scale_, bottom_[2];
    ImVec2 screen_;
    float next_y_[2];
    int left_to_come_[2] = {};
    Side side_ = Side::left;
};

/// Text that goes on in the next line, at a panel's edge or where ImGui is told to.
void wrapped(const ImVec4& colour, const std::string& words);

/// A table of names and values within a panel; ImGui::EndTable() ends it if it was begun.
bool begin_rows(const char* id, float scale);
void row(const char* name, const std::string& value, const ImVec4& colour = panel_colours::plain);

/// As printf, of at most 127 bytes.
std::string text(const char* format, auto... values) {
    char buffer[128];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

/// 1234567 -> "1 234 567": long coordinates can be read.
std::string grouped(long long number);

}  // namespace tessera
