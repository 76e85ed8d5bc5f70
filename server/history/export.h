#pragma once

#include <filesystem>

#include "server/journal/journal.h"
#include "server/progress/progress.h"
#include "server/scene/scene.h"

namespace tessera {

/// Writes the scene in `folder`, as the edits of `journal` up to `revision` left it, as a scene folder of its
/// own: scene file and assets, without a journal. `output` is not there yet, and appears whole or not at all.
/// The new scene's pages have the same texels. Errors: invalid_input, io_failure, cancelled; the message
/// names the file and the fix.
Result<void> export_scene(const std::filesystem::path& folder, Journal& journal, Revision revision,
                          const std::filesystem::path& output, Progress& progress);

}  // namespace tessera
