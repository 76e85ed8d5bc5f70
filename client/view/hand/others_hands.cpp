#include "client/view/hand/others_hands.h"

#include <algorithm>

#include "proto/stream.pb.h"

#include "client/view/hand/hand_edits.h"

namespace tessera {

void OthersHands::hold(std::uint64_t session, const HandSprite& sprite, const HandSprite* there) {
    const auto found = held_.find(session);
    if (found != held_.end() && found->second.sprite == sprite.id && !found->second.is_let_go) {
        carries_.drag(found->second.carry, {sprite});
        return;
    }
    if (found != held_.end()) carries_.drop(found->second.carry);
    std::vector<HandSprite> taken;
    if (there) taken.push_back(*there);
    held_[session] = {.carry = carries_.begin(std::move(taken), {sprite}), .sprite = sprite.id};
}

void OthersHands::let_go(std::uint64_t session, ClientTime now) {
    const auto found = held_.find(session);
    if (found == held_.end() || found->second.is_let_go) return;
    found->second.is_let_go = true;
    found->second.let_go_at = now;
    carries_.sent(found->second.carry);  // an edit may be made by now, and pages on their way
}

void OthersHands::heard(const proto::EditDone& done, ClientTime now) {
    const auto found = held_.find(done.session());
    if (found == held_.end()) return;
    const bool puts_down = std::ranges::any_of(done.changes(), [&](const proto::Change& change) {
        const SpriteId id = found->second.sprite;
        return change.move_sprite().id() == id || change.place_sprite().id() == id;
    });
    if (!puts_down) return;
    carries_.sent(found->second.carry);
    carries_.made(found->second.carry, done.answer().revision(), boxes_of(done.answer()), now);
    held_.erase(found);
}

void OthersHands::tidy(ClientTime now) {
    carries_.tidy(now);
    std::erase_if(held_, [&](const auto& one) {
        if (!one.second.is_let_go || now - one.second.let_go_at <= longest_wait) return false;
        carries_.drop(one.second.carry);
        return true;
    });
}

void OthersHands::clear() {
    carries_.clear();
    held_.clear();
}

}  // namespace tessera
