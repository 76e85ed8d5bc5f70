#pragma once

#include <string>
#include <vector>

#include "proto/edit.pb.h"

#include "server/edits/live_document.h"
#include "server/edits/sprite_book.h"
#include "shared/page/page_key.h"
#include "shared/page/texel_box.h"
#include "shared/wire/sprite_message.h"

namespace tessera {

inline constexpr int max_changes = 1024;

/// What an edit did.
struct AppliedEdit {
    proto::Edit inverse;                 ///< Changes only, in the order that undoes it.
    std::vector<TexelBox> dirty;         ///< Texels of level 0 that may look different, at any step.
    std::vector<proto::Effect> effects;  ///< Of each change_animation.
};

/// The edit's meaning alone, as the journal keeps and compares it: its changes and author, without what a
/// retry may say otherwise and without fields that we do not know. Error: invalid_input, naming the field.
Result<std::string> canonical_edit(const proto::Edit& edit);

/// Sprites are put where they can be seen: inside the extent, or so close that one may reach into it. Asked
/// of edits that come, not of those that the journal has. Error: invalid_input, as apply_edit()'s.
Result<void> check_moves(const proto::Edit& edit, Extent extent);

/// Makes all changes of sprites of an edit, or none, and leaves out the others. The same edit on the same
/// book gives the same book, on every machine. Error: invalid_input; the message names the change and what is
/// wrong
/// ("changes[3].place_sprite.x, y: …").
Result<AppliedEdit> apply_edit(const proto::Edit& edit, const SpritePatterns& patterns, SpriteBook& book);

/// Makes all changes of an edit, or none: of sprites in the book, of all else in the document.
Result<AppliedEdit> apply_edit(const proto::Edit& edit, const SpritePatterns& patterns, SpriteBook& book,
                               const EditInstant& instant, LiveDocument& document,
                               Planning planning = Planning::now);

/// What both parts of an edit did.
AppliedEdit joined(AppliedEdit sprites, DocumentEdit document);

}  // namespace tessera
