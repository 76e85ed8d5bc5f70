#pragma once

#include <string_view>

#include "server/progress/progress.h"
#include "server/texture/texture.h"

namespace tessera {

/// A part of a stage, for work that is itself done in parts.
struct ProgressPart {
    Progress& progress;
    std::string_view stage;
    double begin = 0, length = 1;  ///< Of the stage.

    void advance(double fraction) const { progress.advance(stage, begin + length * fraction); }
    ProgressPart part(double from, double to) const {
        return {progress, stage, begin + length * from, length * (to - from)};
    }
    /// Exact, and stopped as soon as the progress is.
    Budget budget() const { return {.accuracy = Accuracy::exact, .cancelled = progress.stop()}; }
};

}  // namespace tessera
