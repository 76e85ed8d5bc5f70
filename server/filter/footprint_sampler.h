#pragma once

#include <memory>
#include <span>

#include "server/filter/footprint_filter.h"
#include "server/filter/texel_pages.h"
#include "shared/math/footprint.h"

namespace tessera {

/// One filter on one source: the one interface of all filters. Keeps the pages and tables that it used last,
/// within `memory_bytes` of the maker, and is therefore for one thread at a time.
class FootprintSampler {
  public:
    virtual ~FootprintSampler() = default;
    FootprintSampler() = default;
    FootprintSampler(const FootprintSampler&) = delete;
    FootprintSampler& operator=(const FootprintSampler&) = delete;

    /// One sample for each footprint, in order; both spans have one size. The same footprints give the same
    /// bits, whatever was asked before. Errors: invalid_input (check_footprint), cancelled, timed_out.
    virtual Result<void> sample(std::span<const Footprint> footprints, const Budget& budget,
                                std::span<FilteredSample> samples) = 0;
};

std::unique_ptr<FootprintSampler> make_sampler(const FootprintFilter& filter,
                                               std::shared_ptr<const TexelPages> pages,
                                               std::size_t memory_bytes = std::size_t{64} << 20);

}  // namespace tessera
