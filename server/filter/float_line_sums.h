#pragma once

#include <cstdint>

namespace tessera {

/// How precise a line integral texture is at the end of a line of `length` texels (16 to 2^24) whose colours
/// alternate between the brightest and dark ones: the greatest error of the average over any four texels, in
/// 8-bit codes of linear light.
///
/// As the paper keeps it: running sums of the whole line in 32-bit floats ("in practice, single precision is
/// far sufficient", line-integral-textures, section 3.2).
double float_line_error(std::int32_t length);

/// As LineTable keeps it: integers, from the beginning of each page.
double integer_line_error(std::int32_t length);

}  // namespace tessera
