#pragma once

#include <functional>
#include <memory>

#include "client/link/scene_info.h"
#include "client/link/server_address.h"
#include "client/view/camera_path.h"
#include "client/view/options.h"
#include "client/view/view_source.h"
#include "shared/result/result.h"

namespace tessera {

/// Opens the window, and returns when it is closed; or after `options.frames` frames, if that is not 0, the
/// last of them sharp, leaving window.png with the panels in `options.output`. Error: io_failure (no display,
/// no OpenGL 4.5).
/// The window begins at the path's first camera. `source_of` makes a second source, for a part of the picture
/// whose pages have another accuracy.
Result<void> run_window(const Options& options, const SceneInfo& info, const ServerAddress& server,
                        const CameraPath& path, const Surface& surface, ViewSource& source,
                        const std::function<std::unique_ptr<ViewSource>(Accuracy)>& source_of);

}  // namespace tessera
