#include "client/edit/edit_words.h"

#include <array>
#include <cstdio>

namespace tessera {
namespace {

/// As short as it can be written.
std::string number(double value) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.12g", value);
    return text.data();
}

std::string place(double x, double y) { return "(" + number(x) + ", " + number(y) + ")"; }

std::string moving(const proto::SpriteMove& move) {
    std::string words = "move sprite " + std::to_string(move.id());
    if (move.has_x() || move.has_y())
        words += " to (" + (move.has_x() ? number(move.x()) : "same") + ", " +
                 (move.has_y() ? number(move.y()) : "same") + ")";
    if (move.has_scale()) words += ", scale " + number(move.scale());
    if (move.has_turn()) words += ", turn " + number(move.turn());
    if (move.has_order()) words += ", order " + std::to_string(move.order());
    if (move.has_pattern()) words += ", pattern " + std::to_string(move.pattern());
    return words;
}

std::string clock_words(const proto::ClockChange& clock) {
    std::string words = "clock:";
    if (clock.has_playing()) words += clock.playing() ? " play" : " pause";
    if (clock.has_step()) words += " step " + std::to_string(clock.step());
    if (clock.has_steps_per_second()) words += " " + number(clock.steps_per_second()) + " steps/s";
    return words;
}

std::string words_of(const proto::Change& change) {
    switch (change.change_case()) {
        case proto::Change::kPlaceSprite:
            return "place sprite " + std::to_string(change.place_sprite().id()) + " at " +
                   place(change.place_sprite().x(), change.place_sprite().y());
        case proto::Change::kMoveSprite:
            return moving(change.move_sprite());
        case proto::Change::kRemoveSprite:
            return "remove sprite " + std::to_string(change.remove_sprite().id());
        case proto::Change::kPaintMap: {
            const proto::MapPaint& paint = change.paint_map();
            return "paint " + std::to_string(paint.width()) + " x " + std::to_string(paint.height()) +
                   " entries of " + paint.block();
        }
        case proto::Change::kSetParameter:
            return "set " + change.set_parameter().field() +
                   (change.set_parameter().block().empty() ? "" : " of " + change.set_parameter().block());
        case proto::Change::kChangeAnimation:
            return "change the animation of " + change.change_animation().block();
        case proto::Change::kSetTarget:
            return "set target " + std::to_string(change.set_target().id()) + " to (" +
                   std::to_string(change.set_target().x()) + ", " + std::to_string(change.set_target().y()) +
                   ")";
        case proto::Change::kRemoveTarget:
            return "remove target " + std::to_string(change.remove_target().id());
        case proto::Change::kSetClock:
            return clock_words(change.set_clock());
        default:
            return "nothing that this program knows";
    }
}

const char* name_of(proto::EditRefused::Why why) {
    switch (why) {
        case proto::EditRefused::conflict:
            return "conflict";
        case proto::EditRefused::other_content:
            return "an edit of that id is in already, with other content";
        case proto::EditRefused::too_old:
            return "too old";
        case proto::EditRefused::overloaded:
            return "the server is busy";
        case proto::EditRefused::unavailable:
            return "not possible now";
        case proto::EditRefused::unknown:
            return "nobody knows whether it is in";
        case proto::EditRefused::forbidden:
            return "not allowed";
        default:
            return "wrong";
    }
}

}  // namespace

std::string words_of(const proto::Edit& edit) {
    if (edit.changes_size() == 1) return words_of(edit.changes(0));
    return std::to_string(edit.changes_size()) + " changes";
}

std::string words_of(const proto::Edit& edit, const proto::EditAnswer& answer) {
    std::string words = "revision " + std::to_string(answer.revision()) + ": " + words_of(edit);
    if (answer.again()) words += " (was in already)";
    for (const proto::Effect& effect : answer.effects())
        words += "; in effect from step " + std::to_string(effect.step());
    return words;
}

std::string words_of(const proto::Edit& edit, const proto::EditRefused& refusal) {
    std::string words = words_of(edit) + ": " + name_of(refusal.why());
    if (!refusal.detail().empty()) words += ": " + refusal.detail();
    return words;
}

}  // namespace tessera
