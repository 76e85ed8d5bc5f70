#pragma once

#include <cstdint>
#include <optional>

#include "client/residency/camera.h"
#include "client/residency/residency.h"
#include "client/view/metrics/rolling_times.h"

namespace tessera {

/// How long people wait: for a view to become sharp once the camera rests, and for an edit to show once it
/// was heard of. In milliseconds of the client's clock.
class Waits {
  public:
    /// Once a frame. `told_revision` in `history`: what the client has heard of.
    void add(const Camera& camera, const ResidencyFrame& outcome, std::uint32_t history,
             std::uint64_t told_revision, ClientTime now);

    /// From the first frame in which the camera rested, or was somewhere at all, to the first that was sharp.
    /// A view that was sharp already when the camera stopped waited for 0 ms.
    const RollingTimes& to_sharp() const { return to_sharp_; }
    /// From the frame that heard of an edit of something in view to the first that showed all of it.
    const RollingTimes& edit_to_visible() const { return edit_to_visible_; }
    /// How long the present view has not been sharp; nothing while it is, or the camera moves.
    std::optional<ClientTime> waiting_for_sharp(ClientTime now) const;

  private:
    std::optional<Camera> camera_;
    std::optional<ClientTime> rests_since_;  ///< Until it is sharp
    bool was_moving_ = true;
    std::optional<ClientTime> edited_at_;  ///< Until it shows
    std::uint32_t history_ = 0;
    std::uint64_t told_revision_ = 0;
    RollingTimes to_sharp_{256}, edit_to_visible_{256};
};

}  // namespace tessera
