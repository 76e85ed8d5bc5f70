#include "client/view/hand/sprite_book.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/edit.pb.h"

namespace tessera {
namespace {

constexpr std::size_t most_edits = 256;

bool holds(const TexelBox& outer, const TexelBox& inner) {
    return outer.x0 <= inner.x0 && outer.y0 <= inner.y0 && outer.x1 >= inner.x1 && outer.y1 >= inner.y1;
}

}  // namespace

void SpriteBook::begin(std::int32_t patterns, std::int32_t side_texels) {
    const auto view = view_;
    *this = {};
    patterns_ = patterns;
    side_texels_ = side_texels;
    view_ = view;
}

void SpriteBook::look_at(const TexelBox& view) {
    view_ = view;
    const bool closer = partial_ && box_ && view.x1 - view.x0 < (box_->x1 - box_->x0) * 2 / 5;
    if (!box_ || !holds(*box_, view) || closer) is_sure_ = false;
}

std::optional<TexelBox> SpriteBook::take_question() {
    if (is_sure_ || is_asking_ || !view_ || patterns_ == 0) return std::nullopt;
    is_asking_ = is_sure_ = true;
    const std::int64_t dx = (view_->x1 - view_->x0) / 2, dy = (view_->y1 - view_->y0) / 2;
    return TexelBox{view_->x0 - dx, view_->y0 - dy, view_->x1 + dx, view_->y1 + dy};
}

void SpriteBook::answer(const TexelBox& box, const proto::SpriteList& list) {
    is_asking_ = false;
    sprites_.clear();
    for (const proto::SpritePlacement& placed : list.sprites())
        if (auto sprite = hand_sprite_of(placed, patterns_, side_texels_))
            sprites_.insert_or_assign(sprite->id, std::move(*sprite));
    box_ = box;
    partial_ = list.more();
    for (const Edit& edit : edits_)
        if (edit.revision > list.revision()) make(edit.changes);
}

void SpriteBook::take(const std::vector<proto::Change>& changes, std::uint64_t revision,
                      const std::vector<TexelBox>& dirty) {
    const bool is_told = !changes.empty() || !box_ ||
                         std::ranges::none_of(dirty, [&](const TexelBox& one) { return one.meets(*box_); });
    edits_.push_back({revision, changes});
    if (edits_.size() > most_edits) edits_.pop_front();
    if (!make(changes) || !is_told) is_sure_ = false;
}

/// False if a list is needed to know what is there now.
bool SpriteBook::make(const std::vector<proto::Change>& changes) {
    bool known = true;
    for (const proto::Change& change : changes) {
        if (change.has_place_sprite()) {
            auto sprite = hand_sprite_of(change.place_sprite(), patterns_, side_texels_);
            if (sprite && box_ && box_of(*sprite).meets(*box_))
                sprites_.insert_or_assign(sprite->id, std::move(*sprite));
        } else if (change.has_remove_sprite()) {
            sprites_.erase(change.remove_sprite().id());
        } else if (change.has_move_sprite()) {
            const proto::SpriteMove& move = change.move_sprite();
            const auto found = sprites_.find(move.id());
            if (found == sprites_.end()) {
                known = known && !move.has_x() && !move.has_y();
                continue;
            }
            proto::SpritePlacement placed;
            write_hand_sprite(found->second, placed);
            if (move.has_x()) placed.set_x(move.x());
            if (move.has_y()) placed.set_y(move.y());
            if (move.has_scale()) placed.set_scale(move.scale());
            if (move.has_turn()) placed.set_turn(move.turn());
            if (move.has_order()) placed.set_order(move.order());
            if (move.has_pattern()) placed.set_pattern(move.pattern());
            if (auto sprite = hand_sprite_of(placed, patterns_, side_texels_))
                found->second = std::move(*sprite);
        }
    }
    return known;
}

const HandSprite* SpriteBook::find(SpriteId id) const {
    const auto found = sprites_.find(id);
    return found == sprites_.end() ? nullptr : &found->second;
}

std::vector<const HandSprite*> SpriteBook::in_order() const {
    std::vector<const HandSprite*> all;
    all.reserve(sprites_.size());
    for (const auto& [id, sprite] : sprites_) all.push_back(&sprite);
    std::ranges::sort(all, [](const auto* a, const auto* b) { return drawn_before(*a, *b); });
    return all;
}

const HandSprite* SpriteBook::at(const HandPoint& place, double least_half, Step step,
                                 const Covers& covers) const {
    const HandSprite* best = nullptr;
    for (const auto& [id, sprite] : sprites_) {
        if (!there_at(sprite, step) || (best && drawn_before(sprite, *best))) continue;
        const SpritePosition middle = position_at(sprite, step);
        const double dx = static_cast<double>(place.x - middle.x) / sprite_units,
                     dy = static_cast<double>(place.y - middle.y) / sprite_units;
        const double whole = sprite.side_texels * (sprite.scale / double{sprite_scale_one});
        const double farthest = std::max(std::abs(dx), std::abs(dy));
        if (farthest > std::max(whole, least_half)) continue;
        if (whole / 2 < least_half) {
            if (farthest < least_half) best = &sprite;
            continue;
        }
        const double angle = 2 * std::numbers::pi * sprite.turn / 65536.0;
        const double u = (dx * std::cos(angle) + dy * std::sin(angle)) / whole + 0.5,
                     v = (dy * std::cos(angle) - dx * std::sin(angle)) / whole + 0.5;
        if (u >= 0 && v >= 0 && u < 1 && v < 1 && (!covers || covers(sprite, u, v))) best = &sprite;
    }
    return best;
}

std::vector<SpriteId> SpriteBook::within(const TexelBox& box, Step step) const {
    std::vector<SpriteId> inside;
    for (const auto& [id, sprite] : sprites_) {
        if (!there_at(sprite, step)) continue;
        const SpritePosition at = position_at(sprite, step);
        const std::int64_t x = at.x >> 8, y = at.y >> 8;
        if (x >= box.x0 && x < box.x1 && y >= box.y0 && y < box.y1) inside.push_back(id);
    }
    return inside;
}

}  // namespace tessera
