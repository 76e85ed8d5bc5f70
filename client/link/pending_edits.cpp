#include "client/link/pending_edits.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

proto::EditRefused unknown_fate(const proto::Edit& edit, std::string why) {
    proto::EditRefused refusal;
    refusal.set_id(edit.id());
    refusal.set_why(proto::EditRefused::unknown);
    refusal.set_detail(std::move(why));
    return refusal;
}

/// 100 ms, 200 ms, … 5 s
std::chrono::milliseconds back_off(int sends) {
    constexpr std::chrono::milliseconds first{100}, longest{5000};
    return std::min(first * (1 << std::clamp(sends - 1, 0, 10)), longest);
}

}  // namespace

void PendingEdits::add(proto::Edit edit, Completion done, Time now) {
    edits_.push_back({std::move(edit), std::move(done), now});
}

std::vector<PendingEdits::Ended> PendingEdits::opened(std::string_view history) {
    history_ = history;
    std::vector<Ended> ended;
    for (auto entry = edits_.begin(); entry != edits_.end();) {
        const auto next = std::next(entry);
        entry->sent = false;
        entry->due = {};
        if (entry->sends > 0 && entry->history != history_)
            ended.push_back(
                end(entry, unknown_fate(entry->edit,
                                        "the connection was lost before the answer came, and the "
                                        "server counts its edits anew since; see whether it is in")));
        entry = next;
    }
    return ended;
}

bool PendingEdits::may_send() const {
    constexpr int most_on_the_way = 64;  // servers refuse a long queue of one client
    return std::ranges::count_if(edits_, &Entry::sent) < most_on_the_way;
}

const proto::Edit* PendingEdits::take_due(Time now, std::uint64_t newest_revision) {
    if (!may_send()) return nullptr;
    for (Entry& entry : edits_) {
        if (entry.sent || entry.due > now) continue;
        entry.sent = true;
        if (entry.sends++ > 0) {
            ++sent_again_;
        } else {
            entry.history = history_;
            if (entry.edit.known_revision() == 0) entry.edit.set_known_revision(newest_revision);
        }
        return &entry.edit;
    }
    return nullptr;
}

std::optional<PendingEdits::Time> PendingEdits::next_due() const {
    std::optional<Time> next;
    if (!may_send()) return next;
    for (const Entry& entry : edits_)
        if (!entry.sent && (!next || entry.due < *next)) next = entry.due;
    return next;
}

PendingEdits::Entries::iterator PendingEdits::find(std::string_view id) {
    return std::ranges::find_if(edits_, [&](const Entry& entry) { return entry.edit.id() == id; });
}

bool PendingEdits::waits_for(std::string_view id) const {
    return std::ranges::any_of(edits_, [&](const Entry& entry) { return entry.edit.id() == id; });
}

PendingEdits::Ended PendingEdits::end(Entries::iterator entry, EditFate fate) {
    Ended ended{std::move(entry->done), std::move(fate)};
    edits_.erase(entry);
    return ended;
}

std::optional<PendingEdits::Ended> PendingEdits::accepted(const std::string& id,
                                                          const proto::EditAnswer& answer) {
    const auto entry = find(id);
    if (entry == edits_.end() || entry->sends == 0) return std::nullopt;
    return end(entry, answer);
}

std::optional<PendingEdits::Ended> PendingEdits::refused(const proto::EditRefused& refusal, Time now) {
    const auto entry = find(refusal.id());
    if (entry == edits_.end() || entry->sends == 0) return std::nullopt;
    // A refusal for the server's own reasons says nothing of an earlier try whose answer was lost
    const bool passing =
        refusal.why() == proto::EditRefused::overloaded || refusal.why() == proto::EditRefused::unavailable;
    if (refusal.why() == proto::EditRefused::unknown || (passing && entry->sends > 1)) {
        entry->sent = false;
        entry->due = now + back_off(entry->sends);
        return std::nullopt;
    }
    return end(entry, refusal);
}

std::vector<PendingEdits::Ended> PendingEdits::give_up(Time since) {
    std::vector<Ended> ended;
    for (auto entry = edits_.begin(); entry != edits_.end();) {
        const auto next = std::next(entry);
        if (entry->made < since) {
            proto::EditRefused refusal =
                unknown_fate(entry->edit,
                             "no answer came in time; sending it again with the same id and "
                             "known_revision is harmless");
            if (entry->sends == 0) {
                refusal.set_why(proto::EditRefused::unavailable);
                refusal.set_detail("the server was not reached in time; the edit was never sent");
            }
            ended.push_back(end(entry, std::move(refusal)));
        }
        entry = next;
    }
    return ended;
}

}  // namespace tessera
