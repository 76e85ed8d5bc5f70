#include "server/edits/apply_edit.h"

#include <algorithm>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/unknown_field_set.h>
#include <google/protobuf/util/message_differencer.h>

namespace tessera {

namespace {

/// One change, and its inverse in front of those of later ones.
Result<void> place(const proto::SpritePlacement& message, const SpritePatterns& patterns, SpriteBook& book,
                   proto::Change& inverse, std::vector<TexelBox>& dirty) {
    const auto sprite = sprite_of(message, patterns);
    if (!sprite) return sprite.error();
    if (auto placed = book.place(*sprite); !placed) return placed;
    dirty.push_back(box_of(*sprite));
    inverse.mutable_remove_sprite()->set_id(sprite->id);
    return {};
}

Result<void> move(const proto::SpriteMove& message, const SpritePatterns& patterns, SpriteBook& book,
                  proto::Change& inverse, std::vector<TexelBox>& dirty) {
    const auto old = book.find(message.id());
    if (!old)
        return Error{ErrorCode::invalid_input, "id: there is no sprite " + std::to_string(message.id()) +
                                                   "; somebody may have removed it"};
    // Over the wire's own form, so that one place checks what a sprite may be
    proto::SpritePlacement was, becomes;
    write_sprite(*old, was);
    becomes = was;
    proto::SpriteMove& back = *inverse.mutable_move_sprite();
    back.set_id(message.id());
    if (message.has_x()) becomes.set_x(message.x()), back.set_x(was.x());
    if (message.has_y()) becomes.set_y(message.y()), back.set_y(was.y());
    if (message.has_scale())
        becomes.set_scale(message.scale()), back.set_scale(was.has_scale() ? was.scale() : 1);
    if (message.has_turn()) becomes.set_turn(message.turn()), back.set_turn(was.turn());
    if (message.has_order()) becomes.set_order(message.order()), back.set_order(was.order());
    if (message.has_pattern()) becomes.set_pattern(message.pattern()), back.set_pattern(was.pattern());
    const auto sprite = sprite_of(becomes, patterns);
    if (!sprite) return sprite.error();
    if (auto moved = book.replace(*sprite); !moved) return moved;
    // Back where it was taken up: an edit as any other, but no page looks different
    if (write_sprite(*sprite, becomes); google::protobuf::util::MessageDifferencer::Equals(was, becomes))
        return {};
    dirty.push_back(box_of(*old));
    dirty.push_back(box_of(*sprite));
    return {};
}

Result<void> remove(const proto::SpriteRemoval& message, SpriteBook& book, proto::Change& inverse,
                    std::vector<TexelBox>& dirty) {
    const auto old = book.find(message.id());
    if (auto removed = book.remove(message.id()); !removed) return removed;
    dirty.push_back(box_of(*old));
    write_sprite(*old, *inverse.mutable_place_sprite());
    return {};
}

bool is_of_sprites(const proto::Change& change) {
    const auto is = change.change_case();
    return is == proto::Change::kPlaceSprite || is == proto::Change::kMoveSprite ||
           is == proto::Change::kRemoveSprite;
}

Result<void> make(const proto::Change& change, const SpritePatterns& patterns, SpriteBook& book,
                  proto::Change& inverse, std::vector<TexelBox>& dirty) {
    if (patterns.count < 1)
        return Error{ErrorCode::invalid_input,
                     "id: the scene has no sprites; give its scene.json \"sprites\""};
    switch (change.change_case()) {
        case proto::Change::kPlaceSprite:
            return place(change.place_sprite(), patterns, book, inverse, dirty);
        case proto::Change::kMoveSprite:
            return move(change.move_sprite(), patterns, book, inverse, dirty);
        case proto::Change::kRemoveSprite:
            return remove(change.remove_sprite(), book, inverse, dirty);
        default:
            return {};
    }
}

/// Whether a message, or one in it, holds fields that we do not know.
bool has_unknown_fields(const google::protobuf::Message& message) {
    const auto& reflection = *message.GetReflection();
    if (!reflection.GetUnknownFields(message).empty()) return true;
    std::vector<const google::protobuf::FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const auto* field : fields) {
        if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) continue;
        if (!field->is_repeated()) {
            if (has_unknown_fields(reflection.GetMessage(message, field))) return true;
            continue;
        }
        for (int i = 0; i < reflection.FieldSize(message, field); ++i)
            if (has_unknown_fields(reflection.GetRepeatedMessage(message, field, i))) return true;
    }
    return false;
}

}  // namespace

Result<std::string> canonical_edit(const proto::Edit& edit) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::invalid_input, what}; };
    if (edit.changes().empty()) return invalid("changes: is empty; an edit makes at least one change");
    if (edit.changes_size() > max_changes) return invalid("changes: are more than 1024; send several edits");
    if (edit.author().size() > 64) return invalid("author: is longer than 64 bytes");
    if (has_unknown_fields(edit))
        return invalid("holds fields that this server does not know; it is older than the client");
    proto::Edit kept;
    kept.set_author(edit.author());
    *kept.mutable_changes() = edit.changes();
    std::string bytes;
    {
        google::protobuf::io::StringOutputStream stream{&bytes};
        google::protobuf::io::CodedOutputStream coded{&stream};
        coded.SetSerializationDeterministic(true);
        kept.SerializeToCodedStream(&coded);
    }
    return bytes;
}

Result<void> check_moves(const proto::Edit& edit, Extent extent) {
    // Half the diagonal of the largest sprite, 1024 texels at scale 4, rounded up
    constexpr double reach = 3072;
    const auto side = static_cast<double>(extent.side_texels());
    const auto is_far = [&](double at) { return at < -reach || at > side + reach; };
    for (int i = 0; i < edit.changes_size(); ++i) {
        const proto::Change& change = edit.changes(i);
        const proto::SpritePlacement& placed = change.place_sprite();
        const proto::SpriteMove& moved = change.move_sprite();
        if (change.has_move_sprite() && !moved.has_x() && !moved.has_y() && !moved.has_scale() &&
            !moved.has_turn() && !moved.has_order() && !moved.has_pattern())
            return error_of_change(
                i, change,
                Error{ErrorCode::invalid_input, "sets nothing; give it x, y, scale, turn, order or pattern"});
        const char* field = is_far(placed.x()) || is_far(moved.x())   ? "x"
                            : is_far(placed.y()) || is_far(moved.y()) ? "y"
                                                                      : nullptr;
        if (field == nullptr) continue;
        return error_of_change(
            i, change,
            Error{ErrorCode::invalid_input, std::string{field} +
                                                ": is outside of the texture, whose texels are 0 to " +
                                                std::to_string(extent.side_texels() - 1)});
    }
    return {};
}

Result<AppliedEdit> apply_edit(const proto::Edit& edit, const SpritePatterns& patterns, SpriteBook& book) {
    AppliedEdit applied;
    auto& inverses = *applied.inverse.mutable_changes();
    for (int i = 0; i < edit.changes_size(); ++i) {
        const proto::Change& change = edit.changes(i);
        Result<void> made;
        proto::Change inverse;
        if (change.change_case() == proto::Change::CHANGE_NOT_SET)
            made =
                Error{ErrorCode::invalid_input, "says nothing; give it place_sprite, paint_map or another"};
        else if (!is_of_sprites(change))
            continue;
        else
            made = make(change, patterns, book, inverse, applied.dirty);
        if (made) {
            inverses.Add(std::move(inverse));
            continue;
        }
        // None of it, then: what was made is undone, the last first
        proto::Change again;
        std::vector<TexelBox> undone;
        for (int done = inverses.size(); done-- > 0; again.Clear())
            make(inverses.Get(done), patterns, book, again, undone).value();
        return error_of_change(i, change, made.error());
    }
    std::reverse(inverses.begin(), inverses.end());
    return applied;
}

AppliedEdit joined(AppliedEdit sprites, DocumentEdit document) {
    for (proto::Change& inverse : document.inverses) *sprites.inverse.add_changes() = std::move(inverse);
    sprites.dirty.insert(sprites.dirty.end(), document.dirty.begin(), document.dirty.end());
    sprites.effects = std::move(document.effects);
    return sprites;
}

Result<AppliedEdit> apply_edit(const proto::Edit& edit, const SpritePatterns& patterns, SpriteBook& book,
                               const EditInstant& instant, LiveDocument& document, Planning planning) {
    LiveDocument next = document;
    auto of_document = apply_to_document(edit, instant, next, planning);
    if (!of_document) return of_document.error();
    auto of_sprites = apply_edit(edit, patterns, book);
    if (!of_sprites) return of_sprites.error();
    document = std::move(next);
    return joined(std::move(*of_sprites), std::move(*of_document));
}

}  // namespace tessera
