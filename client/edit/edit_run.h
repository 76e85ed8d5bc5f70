#pragma once

#include "client/edit/command_line.h"

namespace tessera {

/// Does what the command line asks for, over a stream. Returns the program's exit code.
int run_edits(const EditOptions& options);

}  // namespace tessera
