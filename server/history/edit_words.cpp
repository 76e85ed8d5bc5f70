#include "server/history/edit_words.h"

#include <charconv>
#include <chrono>
#include <cstdio>

#include "proto/edit.pb.h"

namespace tessera {

namespace {

constexpr int told_changes = 3;

std::string text_of(double number) {
    char digits[32];
    const auto [end, failure] = std::to_chars(digits, digits + sizeof digits, number);
    return failure == std::errc{} ? std::string{digits, end} : "?";
}

std::string sprite(std::uint64_t id) { return "sprite " + std::to_string(id); }

std::string place(const std::string& x, const std::string& y) { return "(" + x + ", " + y + ")"; }

std::string text_of(const proto::Value& value) {
    switch (value.value_case()) {
        case proto::Value::kBlock:
            return "block " + value.block();
        case proto::Value::kInteger:
            return std::to_string(value.integer());
        case proto::Value::kNumber:
            return text_of(value.number());
        case proto::Value::VALUE_NOT_SET:
            break;
    }
    return "nothing";
}

/// "a", "b" and "c" as "a, b, c".
struct List {
    std::string text;
    void add(const std::string& word) { text += (text.empty() ? "" : ", ") + word; }
};

std::string words_for(const proto::SpritePlacement& placed) {
    return "places " + sprite(placed.id()) + ", pattern " + std::to_string(placed.pattern()) + ", at " +
           place(text_of(placed.x()), text_of(placed.y()));
}

std::string words_for(const proto::SpriteMove& move) {
    List changes;
    if (move.has_x() && move.has_y())
        changes.add("moves " + sprite(move.id()) + " to " + place(text_of(move.x()), text_of(move.y())));
    else if (move.has_x() || move.has_y())
        changes.add("moves " + sprite(move.id()) +
                    (move.has_x() ? " to x " + text_of(move.x()) : " to y " + text_of(move.y())));
    else
        changes.add("changes " + sprite(move.id()));
    if (move.has_scale()) changes.add("scale " + text_of(move.scale()));
    if (move.has_turn()) changes.add("turn " + text_of(move.turn()));
    if (move.has_order()) changes.add("order " + std::to_string(move.order()));
    if (move.has_pattern()) changes.add("pattern " + std::to_string(move.pattern()));
    return changes.text;
}

std::string words_for(const proto::MapPaint& paint) {
    std::string text = "paints " + std::to_string(paint.width()) + " × " + std::to_string(paint.height()) +
                       " entries of " + paint.block() + " at " +
                       place(std::to_string(paint.x()), std::to_string(paint.y()));
    if (paint.has_value()) text += " with " + std::to_string(paint.value());
    if (!paint.mask().empty()) text += ", masked";
    return text;
}

std::string words_for(const proto::AnimationChange& change) {
    List changes;
    changes.add("changes the animation of " + change.block());
    if (change.has_step()) changes.add("from step " + std::to_string(change.step()));
    if (change.has_phase()) changes.add("phase " + text_of(change.phase()));
    if (change.has_rest()) changes.add("rest " + text_of(change.rest()));
    if (change.has_density()) changes.add("density " + text_of(change.density()));
    return changes.text;
}

std::string words_for(const proto::Target& target) {
    return "sets target " + std::to_string(target.id()) + " at " +
           place(std::to_string(target.x()), std::to_string(target.y())) +
           (target.legs().empty() ? "" : ", on its way");
}

std::string words_for(const proto::ClockChange& change) {
    List changes;
    if (change.has_playing()) changes.add(change.playing() ? "starts the clock" : "stops the clock");
    if (change.has_step()) changes.add("sets the clock to step " + std::to_string(change.step()));
    if (change.has_steps_per_second())
        changes.add("sets the clock to " + text_of(change.steps_per_second()) + " steps a second");
    return changes.text.empty() ? "changes nothing of the clock" : changes.text;
}

std::string raw_words(const proto::Change& change) {
    switch (change.change_case()) {
        case proto::Change::kPlaceSprite:
            return words_for(change.place_sprite());
        case proto::Change::kMoveSprite:
            return words_for(change.move_sprite());
        case proto::Change::kRemoveSprite:
            return "removes " + sprite(change.remove_sprite().id());
        case proto::Change::kPaintMap:
            return words_for(change.paint_map());
        case proto::Change::kSetParameter:
            return "sets " + change.set_parameter().field() +
                   (change.set_parameter().block().empty() ? "" : " of " + change.set_parameter().block()) +
                   " to " + text_of(change.set_parameter().value());
        case proto::Change::kChangeAnimation:
            return words_for(change.change_animation());
        case proto::Change::kSetTarget:
            return words_for(change.set_target());
        case proto::Change::kRemoveTarget:
            return "removes target " + std::to_string(change.remove_target().id());
        case proto::Change::kSetClock:
            return words_for(change.set_clock());
        case proto::Change::CHANGE_NOT_SET:
            break;
    }
    return "something that this program does not know";
}

}  // namespace

std::string harmless(std::string text) {
    // C1 control characters are two bytes in UTF-8: 0xc2 and 0x80 to 0x9f
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte < 0x20 || byte == 0x7f) text[i] = '?';
        if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0)
            text[i] = text[i + 1] = '?';
    }
    return text;
}

std::string words_for(const proto::Change& change) { return harmless(raw_words(change)); }

std::string words_for(const proto::Edit& edit) {
    std::string text;
    for (int i = 0; i < std::min(edit.changes_size(), told_changes); ++i)
        text += (i == 0 ? "" : "; ") + words_for(edit.changes(i));
    if (edit.changes_size() > told_changes)
        text += "; and " + std::to_string(edit.changes_size() - told_changes) + " changes more";
    return text;
}

std::string text_of(JournalTime time) {
    const auto day = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date{day};
    const std::chrono::hh_mm_ss clock{time - day};
    char text[64];
    std::snprintf(text, sizeof text, "%04d-%02u-%02u %02d:%02d:%02d.%03d", int{date.year()},
                  unsigned{date.month()}, unsigned{date.day()}, static_cast<int>(clock.hours().count()),
                  static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()),
                  static_cast<int>(clock.subseconds().count()));
    return text;
}

}  // namespace tessera
