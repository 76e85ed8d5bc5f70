#pragma once

#include "client/link/scene_info.h"
#include "client/link/server_address.h"
#include "client/residency/camera.h"
#include "client/view/options.h"
#include "client/view/view_source.h"
#include "shared/result/result.h"

namespace tessera {

/// Opens the window, and returns when it is closed; or after `options.frames` frames, if that is not 0, the
/// last of them sharp, leaving window.png with the panels in `options.output`. Error: io_failure (no display,
/// no OpenGL 4.5).
Result<void> run_window(const Options& options, const SceneInfo& info, const ServerAddress& server,
                        const Camera& start, ViewSource& source);

}  // namespace tessera
