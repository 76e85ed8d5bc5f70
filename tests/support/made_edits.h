#pragma once

#include <cstdint>

#include "proto/edit.pb.h"

#include "shared/revisions/edit_id.h"

namespace tessera {

/// An edit of nothing yet, with an id of its own.
inline proto::Edit new_edit() {
    proto::Edit edit;
    edit.set_id(to_string(random_edit_id()));
    return edit;
}

inline proto::Edit placing(std::uint64_t id, double x, double y, std::uint32_t pattern = 0) {
    proto::Edit edit = new_edit();
    proto::SpritePlacement& sprite = *edit.add_changes()->mutable_place_sprite();
    sprite.set_id(id);
    sprite.set_x(x);
    sprite.set_y(y);
    sprite.set_pattern(pattern);
    return edit;
}

inline proto::Edit moving(std::uint64_t id, double x, double y) {
    proto::Edit edit = new_edit();
    proto::SpriteMove& move = *edit.add_changes()->mutable_move_sprite();
    move.set_id(id);
    move.set_x(x);
    move.set_y(y);
    return edit;
}

inline proto::Edit removing(std::uint64_t id) {
    proto::Edit edit = new_edit();
    edit.add_changes()->mutable_remove_sprite()->set_id(id);
    return edit;
}

}  // namespace tessera
