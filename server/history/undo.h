#pragma once

#include <vector>

#include "proto/edit.pb.h"

#include "server/journal/journal.h"
#include "server/progress/progress.h"
#include "server/scene/scene.h"

namespace tessera {

/// Edits that make a scene what it was.
struct Undo {
    Revision head = 0;  ///< What they are based on: the first says so, each next one more.
    std::vector<proto::Edit>
        edits;  ///< Without ids; none if the scene is as it was. One, unless limits ask for more.
    std::string fingerprint;  ///< Of the scene with this journal, as its server says it.
};

/// Finds the edits that bring the scene of `ground` and `journal` back to how it was after `revision`: by
/// what is different, not by undoing one edit after the other, so that a day of dragging is one move. Pages
/// then have the bytes that they had; animations change back by a transition, and a clock that ran goes on.
/// The edits have been tried when this returns. Errors: invalid_input, where the revision is beyond the
/// journal's horizon or not reached, or where something cannot be undone; io_failure; cancelled.
Result<Undo> plan_undo(const ScenePtr& ground, Journal& journal, Revision revision, Progress& progress);

}  // namespace tessera
