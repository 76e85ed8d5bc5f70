#pragma once

#include <map>
#include <set>
#include <vector>

#include "client/residency/needed_pages.h"
#include "tests/simulation/simulated_stream.h"

namespace tessera::testing {

/// What most clients do: ask for each page when it is first needed, in that order, and wait for all of them.
/// The yardstick.
class FifoClient {
  public:
    FifoClient(Extent extent, SimulatedStream& stream) : extent_{extent}, stream_{stream} {}

    struct Frame {
        std::size_t missing = 0;
        double mip_deficit = 0;
        double sharp_share = 1;
        std::size_t arrived = 0;
        std::size_t late = 0;  ///< Of these, no longer needed.
    };
    Frame update(const PlaneView& view, const Sampling& sampling);

  private:
    Extent extent_;
    SimulatedStream& stream_;
    std::set<PageKey> here_, asked_;
    PageRequestId next_id_ = 1;
};

}  // namespace tessera::testing
