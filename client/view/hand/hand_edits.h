#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/link/pending_edits.h"
#include "client/view/hand/edit_history.h"
#include "shared/page/texel_box.h"

namespace tessera {

/// The hand's edits, from when they are sent until their fate is known.
class HandEdits {
  public:
    using Changes = EditHistory::Changes;
    using Way = EditHistory::Way;
    /// Sends an edit, and returns its id.
    using Send = std::function<std::string(proto::Edit)>;

    HandEdits(Send send, std::string author) : send_{std::move(send)}, author_{std::move(author)} {}

    /// `carry`: what shows it meanwhile; 0: nothing. `joins`: undone together with the one before it.
    std::string make(Changes changes, std::uint32_t carry = 0, bool joins = false);
    /// What was undone or done again now, to be shown at once; nothing if there is nothing, or another one is
    /// under way.
    struct Step {
        std::string id;
        Changes changes;
    };
    std::optional<Step> go(Way way);
    /// Shows an edit that go() made.
    void carried(const std::string& id, std::uint32_t carry);

    struct Outcome {
        std::string id;
        Way way = Way::doing;
        std::uint32_t carry = 0;
        Changes changes{};
        bool is_in = false;
        proto::EditAnswer answer{};
        std::string why{};  ///< Of one that is not in: for people
    };
    /// Nothing where the edit is another's.
    std::optional<Outcome> hear(const std::string& id, const EditFate& fate);

    std::size_t waiting() const { return waiting_.size(); }
    bool is_waiting(const std::string& id) const { return waiting_.contains(id); }
    const EditHistory& history() const { return history_; }
    void forget_history() { history_.forget(); }

  private:
    struct Waiting {
        Way way = Way::doing;
        std::uint32_t carry = 0;
        bool joins = false;
        Changes changes{};
    };
    std::string send(Changes changes, Waiting waiting);

    Send send_;
    std::string author_;
    std::map<std::string, Waiting> waiting_;
    EditHistory history_;
};

/// The boxes that an answer names.
std::vector<TexelBox> boxes_of(const proto::EditAnswer& answer);

}  // namespace tessera
