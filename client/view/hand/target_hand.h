#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/edit.pb.h"
#include "proto/scene.pb.h"

#include "client/view/hand/hand_edits.h"
#include "client/view/hand/hand_sprite.h"

namespace tessera {

/// The scene's targets, which animations look at, dragged by hand: a drag sends where it is, one edit under
/// way at a time and the latest wins, and is undone as one.
class TargetHand {
  public:
    explicit TargetHand(HandEdits& edits) : edits_{edits} {}

    /// As the server says they are.
    void set(const google::protobuf::RepeatedPtrField<proto::Target>& targets);
    /// An edit was made.
    void take(const std::vector<proto::Change>& changes);

    /// With the one in the hand where it is.
    std::vector<proto::Target> targets() const;
    /// The one nearest to a point, within so many texels of where it rests or starts.
    std::optional<std::uint64_t> at(const HandPoint& place, double reach_texels) const;

    void press(std::uint64_t id, const HandPoint& at);
    void drag(const HandPoint& at);
    void release();
    std::optional<std::uint64_t> held() const { return held_ ? std::optional{held_->id()} : std::nullopt; }
    /// Sends where it is now, unless an edit is under way. Once a frame.
    void advance();

  private:
    HandEdits& edits_;
    std::map<std::uint64_t, proto::Target> targets_;
    std::optional<proto::Target> held_, start_;
    HandPoint from_{};
    std::string under_way_;
    bool is_sent_ = true, joins_ = false, is_down_ = false;
};

}  // namespace tessera
