#pragma once

#include <vector>

#include "tests/property/stability/subjects.h"

namespace tessera::tests {

/// A texture for each kind of pattern block, generator and axis. With a code (0 to 255) every texel of every
/// pattern and ground has it, and what has holes lies on a ground of it; −1: colours far from each other.
std::vector<Subject> pattern_subjects(int code);

}  // namespace tessera::tests
