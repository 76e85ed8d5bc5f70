#pragma once

#include <cstdint>

#include "server/progress/progress.h"
#include "server/texture/exchange.h"
#include "shared/result/result.h"

namespace tessera {

struct PrepareOptions {
    std::int32_t tile_side =
        512;  ///< A power of two, 16 to 4096. Too small repeats; too large leaves no choice.
    std::int32_t patches = 64;  ///< 16 to 4096. Few keep large objects whole; many vary more.
    std::int32_t contents =
        24;  ///< For each patch beside its own, 1 to 255. Many vary more and fit less well.
    std::int32_t blend_texels = 8;  ///< Even, 0 to 64. Too little shows borders; too much blurs along them.
    std::uint64_t seed = 1;         ///< Another seed, other patches.
    std::size_t threads = 0;        ///< 0: one for each processor. Changes nothing but the time.
};

/// Makes of a photograph what content exchange needs: a periodic tile, patches on it, contents for them. The
/// same photograph, options and seed give the same asset on every machine. What cannot be had as asked (a
/// tile larger than the photograph, more patches than fit) is made smaller, and noted to `progress`. Errors:
/// invalid_input (an option out of range, a photograph too small), cancelled.
Result<ExchangeAsset> prepare_content_exchange(const Rgb8Image& photo, const PrepareOptions& options,
                                                      Progress& progress);

}  // namespace tessera
