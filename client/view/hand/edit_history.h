#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "proto/edit.pb.h"

namespace tessera {

/// What can be undone and done again: the server's own inverse edits, the last `most` of each.
class EditHistory {
  public:
    using Changes = std::vector<proto::Change>;
    enum class Way { doing, undoing, redoing };
    static constexpr std::size_t most = 200;

    bool can_undo() const { return !undo_.empty(); }
    bool can_redo() const { return !redo_.empty(); }
    /// The changes to make now; nothing if there are none. Until made() or refused(), no others are given.
    std::optional<Changes> take(Way way);
    /// An edit of this kind is in. `joins`: it is undone together with the one before it.
    void made(Way way, const proto::EditAnswer& answer, bool joins = false);
    /// One that take() gave is not.
    void refused();
    /// Of a history that is over: nothing of it can be undone.
    void forget();

  private:
    void remember(std::deque<Changes>& stack, const proto::EditAnswer& answer, bool joins);

    std::deque<Changes> undo_, redo_;
    bool is_busy_ = false;
};

}  // namespace tessera
