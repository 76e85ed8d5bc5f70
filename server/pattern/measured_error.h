#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "server/pattern/draw_law.h"
#include "server/texture/texture.h"

namespace tessera {

class Composite;

/// Bounds that were measured hold with this probability.
inline constexpr double measured_confidence = 1 - 1e-6;

/// How far a composition at some level is from what it stands for, where what is put together is drawn by a
/// known law (draw_law.h). Limits that hold whatever the correlation (mean_products.h) know nothing of
/// draws: at the same estimate they are some tens of times what it is really off by. So blocks of a few
/// cells, at places that a hash draws from the whole plane, are composited at level 0 and at each level up
/// to the block's; and larger ones, of whole periods of a map, above that.
///
/// A texel that is no larger than a block may be as far from the mean as the worst one seen, and half as much
/// again, or by 8 deviations, whichever is more. The error of a larger one is a mean of its blocks' errors:
/// their mean stays, deviations that are drawn fall with the root of the number of blocks; those that belong
/// to a place in a map's period do not, as long as the texel is smaller than the period. Two samples at
/// each place tell them apart.
class MeasuredError {
  public:
    /// `composite` lives as long.
    MeasuredError(const Composite& composite, const DrawLaw& law);

    /// A bound in codes for texels of `level` that are composed `depth` levels below and reduced, their
    /// parts' own errors included; infinite where blocks are too large to be composited. Measures when it is
    /// first asked; others wait. Errors: cancelled, timed_out; what was measured until then is kept.
    Result<double> codes(int level, int depth, const Budget& budget) const;

    int cell_log2() const noexcept { return law_.cell_log2; }

  private:
    struct Moments {
        std::array<double, 4> sum{}, squares{}, pairs{}, least{}, most{};
        std::uint64_t count = 0, pair_count = 0;
    };
    /// Compositions at levels above `base`, held against the one at `base`.
    struct Stage {
        int base = 0, top = 0;
        int places = 0;
        bool paired = false;           ///< Two samples at each place.
        std::vector<Moments> moments;  ///< [level − base − 1][composed at − base − 1]
        int done = 0;                  ///< Places.

        Moments& of(int level, int composed) noexcept {
            return moments[static_cast<std::size_t>(level - base - 1) * static_cast<std::size_t>(top - base) +
                           static_cast<std::size_t>(composed - base - 1)];
        }
    };
    Result<void> measure(Stage& stage, const Budget& budget) const;
    Result<std::vector<LinearImage>> errors_at(const Stage& stage, std::int64_t x, std::int64_t y,
                                               const Budget& budget) const;
    /// Of a channel, in codes: the mean, the variance of what was taken for it, and how far from it.
    struct Spread {
        double mean = 0, doubt = 0, reach = 0;
    };
    Spread spread(Stage& stage, int level, int composed, std::size_t channel) const noexcept;

    const Composite& composite_;
    DrawLaw law_;
    mutable std::mutex mutex_;
    mutable Stage blocks_, periods_;
};

}  // namespace tessera
