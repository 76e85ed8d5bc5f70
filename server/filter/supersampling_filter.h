#pragma once

#include <array>
#include <optional>

#include "server/filter/each_footprint.h"
#include "server/filter/lattice.h"
#include "server/filter/texel_range.h"

namespace tessera {

/// Points of the footprint, each with the texel that it falls on (filtering-procedural-textures, "The
/// filtering"): in the middles of side² strata, or anywhere in them, drawn from a hash of the footprint's own
/// numbers. Adaptive: the strata are seen in up to 4×4 blocks, and a block whose samples differ is sampled
/// again with four times as many. Where the footprint is no parallelogram, samples count by the area of their
/// stratum. A footprint of more than 4096 texels' width takes the texels of a coarser level.
class SupersamplingFilter {
  public:
    SupersamplingFilter(const FootprintFilter& filter, std::shared_ptr<const TexelPages> pages,
                        std::size_t memory_bytes)
        : side_{std::clamp(filter.side, 1, 256)},
          blocks_{side_ >= 8   ? 4
                  : side_ >= 4 ? 2
                               : 1},
          jittered_{filter.kind == FilterKind::supersampling_jittered},
          texels_{pages, memory_bytes},
          ranges_{pages, memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading);

  private:
    /// A block of strata, from `from` to `to` of `side`.
    struct Block {
        int from_x = 0, to_x = 0, from_y = 0, to_y = 0, side = 0;
        int count() const noexcept { return (to_x - from_x) * (to_y - from_y); }
    };
    /// The footprint as a map of the unit square, in texels of the level that is sampled.
    struct Map {
        int level = 0;
        std::int64_t x = 0, y = 0;  ///< The texel that points count from.
        TexelPoint at, along, across, twist;
        double weight = 1, weight_along = 0, weight_across = 0;  ///< Of area, its mean 1; linear.
        double greatest_weight = 1;
        bool unbiased = false;  ///< Weights are what they should be: the footprint has an area.
        std::uint64_t key = 0;
    };

    static Map map_of(const Footprint& footprint);
    const std::uint16_t* texel(const Map& map, double s, double t, Reading& reading);
    /// Weighted differences from `reference`, on average; and whether the samples are alike.
    Doubles4 sample(const Map& map, const Block& block, Ints4 reference, bool& alike, Reading& reading);
    std::optional<StepRange> range_of(const Footprint& footprint, const Map& map, Reading& reading);

    int side_, blocks_;
    bool jittered_;
    PageTables<TexelRows> texels_;
    PageTables<TexelRanges> ranges_;
};

}  // namespace tessera
