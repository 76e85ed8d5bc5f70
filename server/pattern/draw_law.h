#pragma once

#include <cstddef>
#include <optional>

#include "server/blocks/plan.h"

namespace tessera {

/// How what a texture shows is drawn: moved by 2^period_log2 texels along x or y, everything is as likely as
/// before, and cells of 2^cell_log2 texels (tiles, where contents are exchanged) do not tell of others, but
/// for what hangs over into the next.
struct DrawLaw {
    int cell_log2 = 0;
    int period_log2 = 0;  ///< At least cell_log2; more where a map that repeats shifts the probabilities.
};

/// Of a texture of the plan. Nothing where that is not known: what moves, volumes, maps that do not repeat
/// after a power of two, numbers of the paper's series.
std::optional<DrawLaw> draw_law(const ReferencePlan& plan);
std::optional<DrawLaw> draw_law(const Plan& plan, std::size_t texture);

}  // namespace tessera
