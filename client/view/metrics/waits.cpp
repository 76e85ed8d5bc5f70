#include "client/view/metrics/waits.h"

namespace tessera {

void Waits::add(const Camera& camera, const ResidencyFrame& outcome, std::uint32_t history,
                std::uint64_t told_revision, ClientTime now) {
    const bool is_moving = camera_ && !(*camera_ == camera);
    camera_ = camera;
    if (is_moving)
        rests_since_.reset();
    else if (was_moving_)
        rests_since_ = now;
    was_moving_ = is_moving;
    if (rests_since_ && outcome.is_sharp()) {
        to_sharp_.add(static_cast<double>((now - *rests_since_).count()));
        rests_since_.reset();
    }

    const bool heard = history != history_ || told_revision > told_revision_;
    history_ = history;
    told_revision_ = told_revision;
    // One that touches nothing in view has nothing to wait for
    if (heard && !edited_at_ && outcome.stale > 0) edited_at_ = now;
    if (edited_at_ && outcome.stale == 0) {
        edit_to_visible_.add(static_cast<double>((now - *edited_at_).count()));
        edited_at_.reset();
    }
}

std::optional<ClientTime> Waits::waiting_for_sharp(ClientTime now) const {
    if (!rests_since_) return std::nullopt;
    return now - *rests_since_;
}

}  // namespace tessera
