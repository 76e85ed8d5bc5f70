#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "proto/stream.pb.h"

namespace tessera {

/// What became of an edit: it is in for good, or it is not and why. EditRefused::unknown: it may be in.
using EditFate = std::variant<proto::EditAnswer, proto::EditRefused>;

/// Edits from the moment they are made to the moment their fate is known, over any number of connections: one
/// whose answer was lost is sent again under the same id, in the order in which they were made. Knows no
/// sockets.
class PendingEdits {
  public:
    using Time = std::chrono::steady_clock::time_point;
    using Completion = std::function<void(EditFate)>;
    struct Ended {
        Completion done;
        EditFate fate;
    };

    void add(proto::Edit edit, Completion done, Time now);

    /// A connection was opened to a history: what was sent is to be sent again. Of another history than an
    /// edit was sent to, nobody can say whether it is in: these end as unknown.
    std::vector<Ended> opened(std::string_view history);

    /// The next edit to be sent, which counts as sent from now on. Null: none is due. One that is sent for
    /// the first time knows `newest_revision`, if it does not say what it knows.
    const proto::Edit* take_due(Time now, std::uint64_t newest_revision);
    /// When the next will be due, if none is now and another may be on the way.
    std::optional<Time> next_due() const;

    /// The server's answer. Nothing where no such edit waits.
    std::optional<Ended> accepted(const std::string& id, const proto::EditAnswer& answer);
    /// Nothing, too, where the edit is tried again: while the answer leaves open whether it is in.
    std::optional<Ended> refused(const proto::EditRefused& refusal, Time now);

    bool waits_for(std::string_view id) const;

    /// Ends those made before `since`.
    std::vector<Ended> give_up(Time since);

    std::size_t size() const noexcept { return edits_.size(); }
    std::uint64_t sent_again() const noexcept { return sent_again_; }

  private:
    struct Entry {
        proto::Edit edit;
        Completion done;
        Time made;
        Time due{};
        bool sent = false;  ///< On this connection, and neither answered nor due again.
        int sends = 0;
        std::string history{};  ///< That it was first sent to.
    };
    using Entries = std::list<Entry>;
    bool may_send() const;
    Entries::iterator find(std::string_view id);
    Ended end(Entries::iterator entry, EditFate fate);

    Entries edits_;  ///< The first made first.
    std::string history_;
    std::uint64_t sent_again_ = 0;
};

}  // namespace tessera
