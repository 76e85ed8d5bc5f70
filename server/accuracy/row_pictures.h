#pragma once

#include "server/accuracy/filter_measurement.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// The picture as it is shown.
Rgba8Image shown(const CodeImage& picture);

/// Differences from the truth, `error_gain` times, on black.
inline constexpr int error_gain = 8;
Rgba8Image shown_error(const CodeImage& truth, const CodeImage& picture);

/// The paper's figure 5 with a legend below: how many texels each pixel fetched. Green: fewer than 16
/// trilinear probes would, `even_texels`; red: more; grey: magnified, less than a texel to a pixel; sky is
/// dark.
inline constexpr double even_texels = 128;
Rgba8Image shown_counts(const View& view, const FilterMeasurement& measurement);

}  // namespace tessera
