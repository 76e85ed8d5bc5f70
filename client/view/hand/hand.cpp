#include "client/view/hand/hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tessera {
namespace {

constexpr std::size_t most_changes = 1024;  ///< The server takes so many in an edit
constexpr double least_hold_pixels = 14;    ///< A sprite can be taken hold of in a square of so many
constexpr double right_turns = 1.0 / 24;

double reach(const HandPoint& from, const HandPoint& to) {
    return std::hypot(static_cast<double>(to.x - from.x), static_cast<double>(to.y - from.y));
}

double turns(const HandPoint& from, const HandPoint& to) {
    return std::atan2(static_cast<double>(to.y - from.y), static_cast<double>(to.x - from.x)) /
           (2 * std::numbers::pi);
}

}  // namespace

void Hand::begin(std::int32_t patterns, std::int32_t side_texels) {
    side_texels_ = side_texels;
    book_.begin(patterns, side_texels);
    lost();
    selected_.clear();
    if (placing_ && *placing_ >= patterns) placing_.reset();
}

void Hand::look(const HandView& view) {
    view_ = view;
    book_.look_at(view.view);
    carries_.tidy(view.now);
    while (!later_.empty() && edits_.waiting() == 0 && !is_holding()) {
        const HandEdits::Way way = later_.front();
        later_.pop_front();
        go_now(way);
    }
    std::erase_if(selected_, [&](SpriteId id) { return !known(id); });
}

void Hand::choose(std::optional<std::int32_t> pattern) {
    cancel();
    placing_ = pattern;
    if (pattern) selected_.clear();
}

// ---- What is there

std::optional<HandSprite> Hand::known(SpriteId id) const {
    if (const HandSprite* carried = carries_.find(id)) return *carried;
    const HandSprite* found = carries_.is_gone(id) ? nullptr : book_.find(id);
    return found ? std::optional{*found} : std::nullopt;
}

std::optional<HandSprite> Hand::now(SpriteId id) const {
    const auto sprite = known(id);
    return sprite ? std::optional{resting_at(*sprite, view_.step)} : std::nullopt;
}

std::vector<HandSprite> Hand::known_selection() const {
    std::vector<HandSprite> sprites;
    for (const SpriteId id : selected_)
        if (auto sprite = known(id)) sprites.push_back(std::move(*sprite));
    return sprites;
}

std::vector<HandSprite> Hand::selection() const {
    std::vector<HandSprite> sprites;
    for (const SpriteId id : selected_)
        if (auto sprite = now(id)) sprites.push_back(std::move(*sprite));
    return sprites;
}

std::optional<SelectionFrame> Hand::frame() const {
    return SelectionFrame::around(selection(), view_.texels_per_pixel);
}

void Hand::select(std::vector<SpriteId> ids) {
    if (ids.size() > most_changes) ids.resize(most_changes);
    selected_ = std::move(ids);
}

void Hand::select_all() { select(book_.within(view_.view, view_.step)); }

std::optional<FrameHandle> Hand::hovered_handle() const {
    const auto around = at_ && !placing_ ? frame() : std::nullopt;
    return around ? handle_at(*around, *at_, view_.texels_per_pixel) : std::nullopt;
}

const HandSprite* Hand::hovered() const {
    if (!at_ || placing_ || is_holding() || hovered_handle()) return nullptr;
    return book_.at(*at_, least_hold_pixels / 2 * view_.texels_per_pixel, view_.step, covers_);
}

std::optional<TexelBox> Hand::marquee() const {
    if (grip_.kind != Grip::Kind::frame || !frame_to_) return std::nullopt;
    const HandPoint &a = grip_.start, &b = *frame_to_;
    return TexelBox{std::min(a.x, b.x) >> 8, std::min(a.y, b.y) >> 8, (std::max(a.x, b.x) >> 8) + 1,
                    (std::max(a.y, b.y) >> 8) + 1};
}

std::optional<HandSprite> Hand::ghost() const {
    if (!placing_ || !at_) return std::nullopt;
    HandSprite sprite;
    sprite.pattern = *placing_;
    sprite.side_texels = static_cast<std::uint16_t>(side_texels_);
    sprite.x = at_->x;
    sprite.y = at_->y;
    return sprite;
}

std::optional<HandSprite> Hand::dragged() const {
    const auto now = carries_.now(carry_);
    return carry_ != 0 && now.size() == 1 ? std::optional{now.front()} : std::nullopt;
}

std::vector<HeldSprite> Hand::held() const {
    std::vector<HeldSprite> held;
    if (!carries_.empty()) held = carries_.held(view_.step, animations_, book_.in_order());
    if (const auto next = ghost())
        held.emplace_back(held_sprite(*next, view_.step, animations_)).opacity = 0.7F;
    return held;
}

// ---- The pointer

bool Hand::press(const HandPoint& at, bool add) {
    at_ = at;
    if (is_holding()) return true;
    grip_ = {.start = at, .add = add};
    frame_to_.reset();
    if (placing_) {
        grip_.kind = Grip::Kind::place;
        return false;  // a drag moves the camera
    }
    if (const auto handle = hovered_handle()) {
        grip_.kind = handle->turns() ? Grip::Kind::turn : Grip::Kind::scale;
        grip_.about = frame()->middle;
        return true;
    }
    const HandSprite* hit = book_.at(at, least_hold_pixels / 2 * view_.texels_per_pixel, view_.step, covers_);
    if (!hit && !add) {
        grip_.kind = Grip::Kind::place;  // a click beside all sprites, unless it becomes a drag
        return false;
    }
    if (!hit) {
        grip_.kind = Grip::Kind::frame;
        return true;
    }
    grip_.kind = Grip::Kind::move;
    grip_.hit = hit->id;
    grip_.is_fresh = std::ranges::find(selected_, hit->id) == selected_.end();
    if (grip_.is_fresh) {
        auto ids = add ? selected_ : std::vector<SpriteId>{};
        ids.push_back(hit->id);
        select(std::move(ids));
    }
    take_up();  // so that the pages without it are here when the drag begins
    return true;
}

void Hand::drag(const HandPoint& at, bool has_moved, bool snap) {
    at_ = at;
    if (!has_moved) return;
    switch (grip_.kind) {
        case Grip::Kind::none:
        case Grip::Kind::place:
            return;
        case Grip::Kind::frame:
            frame_to_ = at;
            return;
        default:
            break;
    }
    if (carry_ == 0) take_up();
    HandChange how;
    if (grip_.kind == Grip::Kind::move) {
        how.dx = at.x - grip_.start.x;
        how.dy = at.y - grip_.start.y;
    } else if (grip_.kind == Grip::Kind::scale) {
        how.about = grip_.about;
        how.scale = std::max(1e-3, reach(how.about, at) / std::max(1.0, reach(how.about, grip_.start)));
    } else {
        how.about = grip_.about;
        how.turns = turns(how.about, at) - turns(how.about, grip_.start);
        if (snap) how.turns = std::floor(how.turns / right_turns + 0.5) * right_turns;
    }
    std::vector<HandSprite> now;
    for (const HandSprite& sprite : carries_.taken(carry_)) now.push_back(changed(sprite, how));
    carries_.drag(carry_, std::move(now));
}

void Hand::release(const HandPoint& at, bool has_moved) {
    at_ = at;
    const Grip grip = std::exchange(grip_, {});
    switch (grip.kind) {
        case Grip::Kind::none:
            return;
        case Grip::Kind::frame:
            if (has_moved) {
                frame_to_ = at;
                grip_ = grip;
                std::vector<SpriteId> ids = selected_;
                for (const SpriteId id : book_.within(*marquee(), view_.step))
                    if (std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
                grip_ = {};
                select(std::move(ids));
            }
            return;
        case Grip::Kind::place:
            if (has_moved) return;  // the camera had it
            if (placing_)
                place(at);
            else if (!grip.add)
                selected_.clear();
            return;
        default:
            break;
    }
    if (has_moved) {
        put_down();
        return;
    }
    carries_.drop(std::exchange(carry_, 0));
    if (grip.kind != Grip::Kind::move) return;
    if (!grip.add)
        select({grip.hit});
    else if (!grip.is_fresh)
        std::erase(selected_, grip.hit);
}

bool Hand::cancel() {
    const bool held = is_holding() || carry_ != 0;
    carries_.drop(std::exchange(carry_, 0));
    grip_ = {};
    return held;
}

void Hand::take_up() {
    carries_.drop(carry_);
    std::vector<HandSprite> taken = known_selection();
    std::vector<HandSprite> now = taken;
    carry_ = carries_.begin(std::move(taken), std::move(now));
}

void Hand::put_down() {
    const Carries::Id carry = std::exchange(carry_, 0);
    HandEdits::Changes changes;
    const auto taken = carries_.taken(carry), now = carries_.now(carry);
    for (std::size_t i = 0; i < taken.size(); ++i)
        for (proto::Change& change : changes_between(taken[i], now[i])) changes.push_back(std::move(change));
    if (changes.empty())
        carries_.drop(carry);
    else
        make(std::move(changes), carry);
}

// ---- What came

void Hand::heard(const HandEdits::Outcome& outcome) {
    if (!outcome.is_in) {
        carries_.drop(outcome.carry);
        message_ = outcome.why;
        later_.clear();
        book_.doubt();
        return;
    }
    const std::vector<TexelBox> dirty = boxes_of(outcome.answer);
    // A retry that was in already tells no inverse, and no boxes: the pages are what is true
    if (outcome.answer.again())
        carries_.drop(outcome.carry);
    else
        carries_.made(outcome.carry, outcome.answer.revision(), dirty, view_.now);
    book_.take(outcome.changes, outcome.answer.revision(), dirty);
}

void Hand::heard(const proto::EditDone& done) {
    book_.take({done.changes().begin(), done.changes().end()}, done.answer().revision(),
               boxes_of(done.answer()));
}

void Hand::lost() {
    cancel();
    later_.clear();
    carries_.clear();
    book_.doubt();
}

}  // namespace tessera
