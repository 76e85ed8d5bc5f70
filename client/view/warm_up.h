#pragma once

#include <chrono>
#include <vector>

#include "client/render/plane_scene.h"

namespace tessera {

/// While nobody does anything, has the driver compile the filters that were not shown yet, one at a time:
/// what is chosen next then appears at once. A software rasteriser takes up to a third of a second for each.
class WarmUp {
  public:
    using Clock = std::chrono::steady_clock;

    /// Once a frame. `at_rest`: nothing moves, and all pages are there. Whether it took time.
    bool advance(bool at_rest, Clock::time_point now, PlaneScene& scene, const PlaneView& view) {
        if (!at_rest) rest_begin_ = now;
        if (cold_.empty() || now - rest_begin_ < least_rest) return false;
        // A filter that the driver refuses is told of when it is chosen
        (void)scene.warm_up(view, {.filter = cold_.back()});
        cold_.pop_back();
        rest_begin_ = now;
        return true;
    }

  private:
    static constexpr auto least_rest = std::chrono::seconds{4};

    std::vector<Filter> cold_{Filter::nearest, Filter::bilinear, Filter::line_integral, Filter::anisotropic,
                              Filter::trilinear};  ///< Last first
    Clock::time_point rest_begin_ = Clock::now();
};

}  // namespace tessera
