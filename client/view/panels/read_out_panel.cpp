#include "client/view/panels/panels.h"

namespace tessera {

void read_out_panel(PanelColumns& columns, const PanelContents& contents) {
    using namespace panel_colours;
    if (columns.begin(PanelColumns::Side::left, "Under the cursor") && begin_rows("cursor", contents.scale)) {
        if (const auto& reading = contents.cursor) {
            row("texel", grouped(reading->texel.x) + ", " + grouped(reading->texel.y));
            row("level", text("%.2f of %d", reading->level, int{contents.scene.extent.n}));
            row("page", grouped(reading->page.x) + ", " + grouped(reading->page.y));
            const bool sharp = reading->shown && reading->shown->level == reading->page.level;
            row("shows", page_state(*reading), sharp ? good : waiting);
        } else {
            for (const char* name : {"texel", "level", "page", "shows"}) row(name, "-");
        }
        ImGui::EndTable();
    }
    columns.end();
}

}  // namespace tessera
