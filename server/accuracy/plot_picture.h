#pragma once

#include "proto/accuracy.pb.h"

#include "shared/page/texel_image.h"

namespace tessera {

/// Error against time, both logarithmic, one panel for each situation, on the texture that suits it (the
/// first ones that were measured where those were not): the picture of README. Pareto fronts are drawn as
/// lines.
Rgba8Image draw_plot(const proto::AccuracyReport& report);

}  // namespace tessera
