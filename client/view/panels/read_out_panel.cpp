#include "client/view/panels/panels.h"

namespace tessera {
namespace {

std::string steps_text(const Validity& validity) {
    const auto from = grouped(validity.from);
    return validity.until == never ? (validity.from <= 0 ? "always" : "from step " + from)
                                   : "steps " + from + " to " + grouped(validity.until - 1);
}

void version_rows(const PageVersion& version) {
    row("revision",
        version.revision == 0 ? "no edit yet" : grouped(static_cast<long long>(version.revision)));
    row("valid", steps_text(version.validity));
    row("bound", version.bound_codes == 0 ? "exact, or not told" : text("%.3f codes", version.bound_codes));
}

}  // namespace

void read_out_panel(PanelColumns& columns, const PanelContents& contents) {
    using namespace panel_colours;
    if (columns.begin(PanelColumns::Side::left, "Under the cursor") && begin_rows("cursor", contents.scale)) {
        if (const auto& reading = contents.cursor) {
            row("texel", grouped(reading->texel.x) + ", " + grouped(reading->texel.y));
            row("level", text("%.2f of %d", reading->level, int{contents.scene.extent.n}));
            row("page", text("%d: ", int{reading->page.level}) + grouped(reading->page.x) + ", " +
                            grouped(reading->page.y));
            const bool sharp = reading->shown && reading->shown->level == reading->page.level;
            row("shows", page_state(*reading), sharp ? good : waiting);
            version_rows(reading->version.value_or(PageVersion{}));
        } else {
            for (const char* name : {"texel", "level", "page", "shows", "revision", "valid", "bound"})
                row(name, "-");
        }
        ImGui::EndTable();
    }
    columns.end();
}

}  // namespace tessera
