// What a hand does to what is selected, and undoes.
#include <algorithm>
#include <cmath>

#include "client/view/hand/hand.h"

namespace tessera {
namespace {

constexpr std::size_t most_changes = 1024;  ///< The server takes so many in an edit

}  // namespace

void Hand::make(HandEdits::Changes changes, Carries::Id carry) {
    if (changes.size() > most_changes) {
        message_ =
            "So many at once are no edit: " + std::to_string(changes.size()) + " changes, at most 1024";
        carries_.drop(carry);
        return;
    }
    later_.clear();  // it is this that would be undone
    edits_.make(std::move(changes), carry);
    carries_.sent(carry);
}

void Hand::place(const HandPoint& at) {
    const std::int64_t side = extent_.side_texels() * sprite_units;
    if (at.x < 0 || at.y < 0 || at.x >= side || at.y >= side) {
        message_ = "That is outside of the texture";
        return;
    }
    auto sprite = ghost();
    sprite->id = new_sprite_id();
    HandEdits::Changes changes(1);
    write_hand_sprite(*sprite, *changes.front().mutable_place_sprite());
    make(std::move(changes), carries_.begin({}, {*sprite}));
}

void Hand::remove() {
    cancel();
    std::vector<HandSprite> gone = known_selection();
    if (gone.empty()) return;
    selected_.clear();
    HandEdits::Changes changes;
    for (const HandSprite& sprite : gone) changes.emplace_back().mutable_remove_sprite()->set_id(sprite.id);
    make(std::move(changes), carries_.begin(std::move(gone), {}));
}

void Hand::duplicate() {
    cancel();
    const std::vector<HandSprite> originals = known_selection();
    if (originals.empty()) return;
    const TexelBox box = box_around(originals, view_.step);
    const double quarter = static_cast<double>(box.x1 - box.x0) / 4;
    const auto shift = static_cast<std::int64_t>(
        sprite_units * std::max(8.0, std::floor(std::min(quarter, 24 * view_.texels_per_pixel))));
    HandEdits::Changes changes;
    std::vector<HandSprite> copies;
    std::vector<SpriteId> ids;
    for (const HandSprite& original : originals) {
        HandSprite copy = changed(original, {.dx = shift, .dy = shift});
        copy.id = new_sprite_id();
        ids.push_back(copy.id);
        write_hand_sprite(copy, *changes.emplace_back().mutable_place_sprite());
        copies.push_back(std::move(copy));
    }
    make(std::move(changes), carries_.begin({}, std::move(copies)));
    select(std::move(ids));
}

void Hand::replace_each(const std::vector<HandSprite>& after) {
    cancel();
    carry_ = carries_.begin(known_selection(), after);
    put_down();
}

void Hand::raise(bool up) {
    std::vector<HandSprite> sprites = known_selection();
    std::optional<std::int32_t> outermost;
    for (const HandSprite* other : book_.in_order()) {
        if (std::ranges::find(selected_, other->id) != selected_.end()) continue;
        if (!outermost || (up ? other->order > *outermost : other->order < *outermost))
            outermost = other->order;
    }
    for (HandSprite& sprite : sprites) sprite.order = outermost.value_or(0) + (outermost ? (up ? 1 : -1) : 0);
    replace_each(sprites);
}

void Hand::change_together(HandChange how) {
    const auto around = frame();
    if (!around) return;
    how.about = around->middle;
    std::vector<HandSprite> sprites = known_selection();
    for (HandSprite& sprite : sprites) sprite = changed(sprite, how);
    replace_each(sprites);
}

void Hand::preview_each(const std::function<void(HandSprite&)>& change) {
    if (carry_ == 0) take_up();
    const auto now = carries_.now(carry_);
    std::vector<HandSprite> sprites{now.begin(), now.end()};
    for (HandSprite& sprite : sprites) change(sprite);
    carries_.drag(carry_, std::move(sprites));
}

void Hand::preview_scale(double scale) {
    preview_each([&](HandSprite& sprite) { set_scale(sprite, scale); });
}

void Hand::preview_turns(double turn) {
    preview_each([&](HandSprite& sprite) { set_turns(sprite, turn); });
}

void Hand::put_preview() {
    if (carry_ != 0 && !is_holding()) put_down();
}

void Hand::set_scale_of_each(double scale) {
    preview_scale(scale);
    put_preview();
}

void Hand::set_turns_of_each(double turn) {
    preview_turns(turn);
    put_preview();
}

bool Hand::go(HandEdits::Way way) {
    constexpr std::size_t most_later = 64;
    cancel();
    if (edits_.waiting() == 0 && later_.empty()) return go_now(way);
    if (later_.size() < most_later) later_.push_back(way);
    return true;
}

bool Hand::go_now(HandEdits::Way way) {
    const auto step = edits_.go(way);
    if (!step) return false;
    // What it will have done, to be seen at once
    std::vector<HandSprite> taken;
    SpriteBook after = book_;
    for (const proto::Change& change : step->changes) {
        const SpriteId id = change.has_move_sprite()     ? change.move_sprite().id()
                            : change.has_remove_sprite() ? change.remove_sprite().id()
                                                         : 0;
        if (const auto sprite = id != 0 ? known(id) : std::nullopt) taken.push_back(*sprite);
    }
    after.take(step->changes, 0, {});
    std::vector<HandSprite> now;
    for (const proto::Change& change : step->changes) {
        const SpriteId id = change.has_move_sprite()    ? change.move_sprite().id()
                            : change.has_place_sprite() ? change.place_sprite().id()
                                                        : 0;
        if (const HandSprite* sprite = id != 0 ? after.find(id) : nullptr) now.push_back(*sprite);
    }
    if (taken.empty() && now.empty()) return true;
    const Carries::Id carry = carries_.begin(std::move(taken), std::move(now));
    edits_.carried(step->id, carry);
    carries_.sent(carry);
    return true;
}

}  // namespace tessera
