#pragma once

#include "client/view/panels/panel_columns.h"
#include "client/view/panels/panel_contents.h"

namespace tessera {

/// Fonts, colours and sizes of the panels, for a screen of this scale. Again whenever the scale changes.
void style_panels(float content_scale);

/// All panels, as switched: each is a file of its own.
void draw_panels(const PanelContents& contents, ViewerSwitches& switches);

void scene_panel(PanelColumns& columns, const PanelContents& contents);     ///< What this is, where we are
void read_out_panel(PanelColumns& columns, const PanelContents& contents);  ///< What is under the cursor
void view_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches);
/// With its legend.
void overlay_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches);
/// The names of a split picture's parts, and the handle of the line between.
void split_labels(const PanelContents& contents, const ViewerSwitches& switches);
void filter_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches);
void pages_panel(PanelColumns& columns, const PanelContents& contents,
                 ViewerSwitches& switches);                                  ///< Cache and requests
void metrics_overlay(PanelColumns& columns, const PanelContents& contents);  ///< The session's figures
void frames_panel(PanelColumns& columns, const PanelContents& contents, ViewerSwitches& switches);
void trouble_message(const PanelContents& contents);  ///< In the corner, while something is wrong
void notice_message(const PanelContents& contents);   ///< What a key just did
void help_overlay(float scale, ViewerSwitches& switches);

}  // namespace tessera
