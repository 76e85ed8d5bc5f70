#include "client/view/panels/panel_columns.h"

#include <algorithm>
#include <array>
#include <string>

#include <gtest/gtest.h>

namespace tessera {
namespace {

/// Panels that are higher than there is room for, in a window that nobody sees.
class Panels : public ::testing::Test {
  protected:
    inline static const std::array<std::string, 5> names{"one", "two", "three", "four", "five"};

    Panels() {
        ImGui::CreateContext();
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        ImGui::GetIO().IniFilename = nullptr;
        ImGui::GetIO().Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
    }
    ~Panels() override { ImGui::DestroyContext(); }
    Panels(const Panels&) = delete;
    Panels& operator=(const Panels&) = delete;

    struct Edges {
        float left = 1e9F, right = 0, bottom = 0;
    };
    /// Where they stand once their sizes are known.
    static Edges edges(PanelColumns::Side side, ImVec2 screen, float scale, const PanelRoom& room) {
        ImGui::GetIO().DisplaySize = screen;
        static int round = 0;  // folded panels would stay folded
        ++round;
        Edges edges;
        for (int frame = 0; frame < 12; ++frame) {
            ImGui::GetIO().DeltaTime = 1.0F / 60;
            ImGui::NewFrame();
            PanelColumns columns{scale, room};
            columns.expect(side, static_cast<int>(names.size()));
            edges = {};
            for (const std::string& name : names) {
                if (columns.begin(side, (name + std::to_string(round)).c_str()))
                    ImGui::Dummy({20, 300 * scale});
                const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
                edges = {std::min(edges.left, at.x), std::max(edges.right, at.x + size.x),
                         std::max(edges.bottom, at.y + size.y)};
                columns.end();
            }
            ImGui::EndFrame();
        }
        return edges;
    }
};

TEST_F(Panels, LeaveTheRoomFreeThatBarsBelowThemTake) {
    for (const float scale : {1.0F, 2.0F}) {
        const ImVec2 screen{640 * scale, 480 * scale};
        const Edges whole = edges(PanelColumns::Side::left, screen, scale, {});
        EXPECT_LE(whole.bottom, screen.y);
        const Edges less = edges(PanelColumns::Side::left, screen, scale, {.below_left = 120 * scale});
        EXPECT_LE(less.bottom, screen.y - 120 * scale);
        EXPECT_LT(less.bottom, whole.bottom);
        const Edges right = edges(PanelColumns::Side::right, screen, scale, {.below_left = 120 * scale});
        EXPECT_EQ(right.bottom, whole.bottom) << "the other column has its own room";
    }
}

TEST_F(Panels, ReachAsFarAsTheyAreSaidToAndNeverMeet) {
    for (const float width : {200.0F, 640.0F, 2560.0F}) {
        const ImVec2 screen{width, 600};
        const Edges left = edges(PanelColumns::Side::left, screen, 1, {});
        const Edges right = edges(PanelColumns::Side::right, screen, 1, {});
        EXPECT_NEAR(left.right, PanelColumns::reach(PanelColumns::Side::left, 1), 1);
        EXPECT_NEAR(screen.x - right.left, PanelColumns::reach(PanelColumns::Side::right, 1), 1);
        EXPECT_LT(left.right, right.left);
    }
}

}  // namespace
}  // namespace tessera
