#pragma once

#include <functional>
#include <string>

#include "client/residency/residency.h"
#include "tests/simulation/simulated_stream.h"

namespace tessera::testing {

/// A camera that moves for a while and then rests, and the link that its pages come over.
struct Flight {
    std::string name;
    LinkSettings link;
    std::function<Camera(double seconds)> camera;
    double moving_seconds = 2;
    Sampling sampling{Sampling::Kind::anisotropic};
    Extent extent{20};
};

struct FlightResult {
    double mip_deficit = 0;          ///< Mean over the frames in motion, pixel by pixel.
    double sharp_share = 0;          ///< As mip_deficit.
    double sharp_after_seconds = 0;  ///< After the camera stopped.
    std::uint64_t pages_sent = 0;
    std::uint64_t late = 0;      ///< Pages that arrived when no frame, then or later, sampled them.
    double missing_bytes = 0;    ///< Of the pages that the first resting view needs and has not.
    double missing_seconds = 0;  ///< missing_bytes over the link, and its round trip.
    double late_share() const {
        return pages_sent > 0 ? static_cast<double>(late) / static_cast<double>(pages_sent) : 0;
    }
};

/// 60 frames a second at 800×700, until all is sharp.
FlightResult fly(const Flight& flight, const ResidencySettings& settings);
/// The same with FifoClient.
FlightResult fly_first_in_first_out(const Flight& flight);

}  // namespace tessera::testing
