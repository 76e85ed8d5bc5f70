#include "client/view/hand/hand_edits.h"

#include <utility>

namespace tessera {
namespace {

std::string words_of(const proto::EditRefused& refused) {
    switch (refused.why()) {
        case proto::EditRefused::conflict:
            return "Somebody changed it first: " + refused.detail();
        case proto::EditRefused::forbidden:
            return "Not allowed here: " + refused.detail();
        case proto::EditRefused::unknown:
        case proto::EditRefused::too_old:
            return "Nobody can say whether the edit was made: " + refused.detail();
        default:
            return "Not made: " + refused.detail();
    }
}

}  // namespace

std::vector<TexelBox> boxes_of(const proto::EditAnswer& answer) {
    std::vector<TexelBox> boxes;
    for (const proto::DirtyBox& box : answer.dirty())
        boxes.push_back({box.x0(), box.y0(), box.x1(), box.y1()});
    return boxes;
}

std::string HandEdits::send(Changes changes, Waiting waiting) {
    proto::Edit edit;
    edit.set_author(author_);
    for (const proto::Change& change : changes) *edit.add_changes() = change;
    waiting.changes = std::move(changes);
    std::string id = send_(std::move(edit));
    waiting_.insert_or_assign(id, std::move(waiting));
    return id;
}

std::string HandEdits::make(Changes changes, std::uint32_t carry, bool joins) {
    return send(std::move(changes), {.carry = carry, .joins = joins});
}

std::optional<HandEdits::Step> HandEdits::go(Way way) {
    auto changes = history_.take(way);
    if (!changes) return std::nullopt;
    std::string id = send(*changes, {.way = way});
    return Step{std::move(id), std::move(*changes)};
}

void HandEdits::carried(const std::string& id, std::uint32_t carry) {
    if (const auto found = waiting_.find(id); found != waiting_.end()) found->second.carry = carry;
}

std::optional<HandEdits::Outcome> HandEdits::hear(const std::string& id, const EditFate& fate) {
    const auto found = waiting_.find(id);
    if (found == waiting_.end()) return std::nullopt;
    Waiting waiting = std::move(found->second);
    waiting_.erase(found);
    Outcome outcome{
        .id = id, .way = waiting.way, .carry = waiting.carry, .changes = std::move(waiting.changes)};
    if (const auto* answer = std::get_if<proto::EditAnswer>(&fate)) {
        outcome.is_in = true;
        outcome.answer = *answer;
        history_.made(waiting.way, *answer, waiting.joins);
    } else {
        outcome.why = words_of(std::get<proto::EditRefused>(fate));
        if (waiting.way != Way::doing) history_.refused();
    }
    return outcome;
}

}  // namespace tessera
