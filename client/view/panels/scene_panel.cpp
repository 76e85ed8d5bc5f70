#include "client/view/panels/panels.h"

namespace tessera {

void scene_panel(PanelColumns& columns, const PanelContents& contents) {
    using namespace panel_colours;
    const std::string& title = contents.scene.title.empty() ? contents.scene.id : contents.scene.title;
    if (columns.begin(PanelColumns::Side::left, (title + "###scene").c_str())) {
        wrapped(quiet, contents.scene.id + " on " + contents.server);
        if (begin_rows("camera", contents.scale)) {
            const Camera& camera = contents.view.camera();
            row("above", grouped(camera.ground.x) + ", " + grouped(camera.ground.y));
            row("height", camera.height_texels < 1e6 ? text("%.1f texels", camera.height_texels)
                                                     : text("%.4g texels", camera.height_texels));
            const double yaw = camera.yaw_degrees < 0 ? camera.yaw_degrees + 360 : camera.yaw_degrees;
            row("heading", text("%.0f\xc2\xb0, pitch %.0f\xc2\xb0", yaw, camera.pitch_degrees));
            if (const ViewSource::State& source = contents.source; source.is_live) {
                row("revision",
                    grouped(static_cast<long long>(source.revision)) +
                        (source.others > 0 ? ", others here: " + std::to_string(source.others) : ""));
                row("clock", "step " + grouped(contents.step));
            }
            ImGui::EndTable();
        }
        if (!contents.scene.attribution.empty()) wrapped(quiet, contents.scene.attribution);
        if (contents.is_recording) ImGui::TextColored(bad, "recording the camera; R stops");
        if (contents.is_playing) ImGui::TextColored(good, "playing a camera path; L stops");
        ImGui::TextColored(quiet, "H: all keys   Tab: hide the panels");
    }
    columns.end();
}

}  // namespace tessera
