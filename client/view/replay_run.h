#pragma once

#include "client/view/options.h"
#include "shared/result/result.h"

namespace tessera {

/// Draws the recorded session of `options.replay` again, in a window or without one, and prints whether all
/// hashes are equal. Pictures go to `options.output`, if there is one. Error: invalid_input (no such file,
/// another version; or it differs, or breaks off: printed already), io_failure (no context, cannot write).
Result<void> run_replay(const Options& options);

}  // namespace tessera
