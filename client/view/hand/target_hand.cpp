#include "client/view/hand/target_hand.h"

#include <cmath>

namespace tessera {

void TargetHand::set(const google::protobuf::RepeatedPtrField<proto::Target>& targets) {
    targets_.clear();
    for (const proto::Target& target : targets) targets_[target.id()] = target;
}

void TargetHand::take(const std::vector<proto::Change>& changes) {
    for (const proto::Change& change : changes) {
        if (change.has_set_target()) targets_[change.set_target().id()] = change.set_target();
        if (change.has_remove_target()) targets_.erase(change.remove_target().id());
    }
}

std::vector<proto::Target> TargetHand::targets() const {
    std::vector<proto::Target> all;
    for (const auto& [id, target] : targets_) all.push_back(held_ && held_->id() == id ? *held_ : target);
    return all;
}

std::optional<std::uint64_t> TargetHand::at(const HandPoint& place, double reach_texels) const {
    std::optional<std::uint64_t> nearest;
    for (const auto& [id, target] : targets_) {
        const double away = std::hypot(static_cast<double>(place.x / sprite_units - target.x()),
                                       static_cast<double>(place.y / sprite_units - target.y()));
        if (away > reach_texels) continue;
        reach_texels = away;
        nearest = id;
    }
    return nearest;
}

void TargetHand::press(std::uint64_t id, const HandPoint& at) {
    const auto found = targets_.find(id);
    if (found == targets_.end()) return;
    held_ = start_ = found->second;
    from_ = at;
    is_down_ = is_sent_ = true;
    joins_ = false;
}

void TargetHand::drag(const HandPoint& at) {
    if (!held_ || !is_down_) return;
    const std::int64_t dx = (at.x - from_.x) >> 8, dy = (at.y - from_.y) >> 8;
    if (held_->x() == start_->x() + dx && held_->y() == start_->y() + dy) return;
    held_->set_x(start_->x() + dx);
    held_->set_y(start_->y() + dy);
    // All of its way goes with it
    for (int leg = 0; leg < held_->legs_size(); ++leg) {
        held_->mutable_legs(leg)->set_x(start_->legs(leg).x() + dx);
        held_->mutable_legs(leg)->set_y(start_->legs(leg).y() + dy);
    }
    is_sent_ = false;
}

void TargetHand::release() { is_down_ = false; }

void TargetHand::advance() {
    if (!held_ || edits_.is_waiting(under_way_)) return;
    under_way_.clear();
    if (is_sent_) {
        if (!is_down_) held_.reset();
        return;
    }
    HandEdits::Changes changes(1);
    *changes.front().mutable_set_target() = *held_;
    under_way_ = edits_.make(std::move(changes), 0, joins_);
    is_sent_ = joins_ = true;
}

}  // namespace tessera
