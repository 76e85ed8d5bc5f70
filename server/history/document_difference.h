#pragma once

#include <vector>

#include "server/history/scene_state.h"
#include "server/journal/journal.h"

namespace tessera {

/// The changes that make everything of `now` but its sprites as it is `then`, which was after revision
/// `then_revision` of `journal`: entries of maps that differ, fields that were set since, targets, the clock;
/// animations change back by a transition, as they do for every edit. Error: io_failure, where the journal
/// cannot be read.
Result<std::vector<proto::Change>> document_difference(const SceneState& now, const SceneState& then,
                                                       Journal& journal, Revision then_revision);

}  // namespace tessera
