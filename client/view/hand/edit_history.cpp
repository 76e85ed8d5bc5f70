#include "client/view/hand/edit_history.h"

#include <utility>

namespace tessera {
namespace {

constexpr std::size_t most_joined = 48;  ///< Changes: an edit has at most 64 KiB

}  // namespace

std::optional<EditHistory::Changes> EditHistory::take(Way way) {
    std::deque<Changes>& stack = way == Way::undoing ? undo_ : redo_;
    if (is_busy_ || stack.empty() || way == Way::doing) return std::nullopt;
    is_busy_ = true;
    Changes changes = std::move(stack.back());
    stack.pop_back();
    return changes;
}

void EditHistory::made(Way way, const proto::EditAnswer& answer, bool joins) {
    if (way == Way::doing)
        redo_.clear();
    else
        is_busy_ = false;
    remember(way == Way::undoing ? redo_ : undo_, answer, joins);
}

void EditHistory::refused() { is_busy_ = false; }

void EditHistory::forget() { *this = {}; }

void EditHistory::remember(std::deque<Changes>& stack, const proto::EditAnswer& answer, bool joins) {
    const auto& inverse = answer.inverse().changes();
    if (inverse.empty()) return;
    Changes changes{inverse.begin(), inverse.end()};
    if (joins && !stack.empty() && stack.back().size() + changes.size() <= most_joined) {
        // The last is undone first
        changes.insert(changes.end(), stack.back().begin(), stack.back().end());
        stack.back() = std::move(changes);
        return;
    }
    stack.push_back(std::move(changes));
    if (stack.size() > most) stack.pop_front();
}

}  // namespace tessera
