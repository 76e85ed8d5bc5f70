#include "client/residency/page_requests.h"

#include <algorithm>
#include <tuple>

#include "client/residency/stand_ins.h"

namespace tessera {
namespace {

constexpr std::size_t most_failures_remembered = 4096;
constexpr int failures_before_rest = 3;  ///< In a row: then it is the server, not a page.

}  // namespace

void PageRequests::want(std::vector<WantedPage> wanted, ClientTime now) {
    ++frame_;
    window_.frame(now);
    for (const WantedPage& want : wanted)
        if (const auto found = id_of_.find(want.page); found != id_of_.end())
            under_way_.at(found->second).wanted_in_frame = frame_;
    cancel_unwanted(now);
    ask(std::move(wanted), now);
}

void PageRequests::cancel_unwanted(ClientTime now) {
    std::vector<PageRequestId> silent;
    for (auto& [id, state] : under_way_) {
        if (now - state.sent > limits_.patience) {
            silent.push_back(id);
            continue;
        }
        if (state.cancelled || state.wanted_in_frame + limits_.frames_unwanted >= frame_) continue;
        state.cancelled = true;
        source_.cancel(id);
    }
    for (const PageRequestId id : silent) {
        const PageKey page = under_way_.at(id).page;
        source_.cancel(id);
        window_.lost(id);
        under_way_.erase(id);
        id_of_.erase(page);
        fail(page,
             {ErrorCode::timed_out,
              "no answer within " + std::to_string(limits_.patience.count() / 1000) + " s"},
             ClientTime{0}, now);
    }
}

void PageRequests::ask(std::vector<WantedPage> wanted, ClientTime now) {
    if (now < resting_until_) return;
    // While the source keeps failing, one request at a time finds out whether it is back
    const std::size_t most = failures_in_a_row_ >= failures_before_rest ? 1 : window_.answers();
    if (most != allowed_) source_.allow(allowed_ = most);
    if (under_way_.size() >= most) return;
    std::erase_if(wanted, [&](const WantedPage& want) {
        if (id_of_.contains(want.page)) return true;
        const auto failure = failures_.find(want.page);
        return failure != failures_.end() && (failure->second.for_good || now < failure->second.not_before);
    });
    const auto more_valuable = [](const WantedPage& a, const WantedPage& b) {
        return std::tie(b.gain, b.page.level, a.page) < std::tie(a.gain, a.page.level, b.page);
    };
    const std::size_t room = most - under_way_.size(), starting = std::min(wanted.size(), room);
    std::partial_sort(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(starting), wanted.end(),
                      more_valuable);
    for (std::size_t i = 0; i < starting; ++i) {
        WantedPage& want = wanted[i];
        while (under_way_.contains(next_id_)) ++next_id_;
        const PageRequestId id = next_id_++;
        if (!source_.request({.id = id,
                              .page = want.page,
                              .least_revision = want.least_revision,
                              .step = want.step,
                              .urgency = want.urgency,
                              .have = std::move(want.have)}))
            return;
        under_way_[id] = {want.page, frame_, now, false};
        id_of_[want.page] = id;
        window_.sent(id, now, wanted.size() >= room);
        ++counts_.requested;
    }
}

std::vector<ArrivedPage> PageRequests::take_arrived(std::size_t most, ClientTime now,
                                                    std::vector<PageKey>* without) {
    std::vector<ArrivedPage> arrived = source_.take_arrived(most);
    std::erase_if(arrived, [&](ArrivedPage& answer) {
        if (StandIns::is_one(answer.id)) {
            others_.push_back(std::move(answer));
            return true;
        }
        const auto found = under_way_.find(answer.id);
        if (found == under_way_.end() || found->second.page != answer.page) {
            ++counts_.unasked;
            return true;
        }
        const UnderWay state = found->second;
        under_way_.erase(found);
        id_of_.erase(answer.page);
        if (answer.texels && (answer.unchanged || answer.texels->size() == slot_bytes)) {
            window_.arrived(answer.id, answer.wire_bytes > 0 ? answer.wire_bytes : slot_bytes, now);
            failures_.erase(answer.page);
            failures_in_a_row_ = 0;
            problem_.clear();
            ++(answer.unchanged ? counts_.unchanged : counts_.arrived);
            counts_.late += state.wanted_in_frame + limits_.frames_unwanted < frame_ ? 1 : 0;
            return false;
        }
        window_.lost(answer.id);
        if (without) without->push_back(answer.page);
        const ClientTime retry{answer.retry_ms};
        if (answer.texels) {
            fail(answer.page,
                 {ErrorCode::io_failure, "a page of " + std::to_string(answer.texels->size()) +
                                             " bytes arrived, not of " + std::to_string(slot_bytes)},
                 retry, now);
        } else if (state.cancelled || answer.texels.error().code == ErrorCode::cancelled) {
            ++counts_.cancelled;
        } else {
            fail(answer.page, answer.texels.error(), retry, now);
        }
        return true;
    });
    return arrived;
}

void PageRequests::fail(PageKey page, const Error& error, ClientTime retry, ClientTime now) {
    ++counts_.failed;
    problem_ = error.detail;
    if (failures_.size() >= most_failures_remembered) failures_.clear();
    Failure& failure = failures_[page];
    ++failure.count;
    failure.not_before = now + std::max(back_off(failure.count), std::min(retry, limits_.longest_back_off));
    failure.for_good = error.code == ErrorCode::no_such_page || error.code == ErrorCode::malformed_request;
    if (failure.for_good) return;
    ++failures_in_a_row_;
    if (failures_in_a_row_ >= failures_before_rest)
        resting_until_ =
            std::max(resting_until_, now + back_off(failures_in_a_row_ - failures_before_rest + 1));
}

ClientTime PageRequests::back_off(int failures) const {
    return std::min(limits_.longest_back_off, limits_.first_back_off * (1 << std::min(failures - 1, 16)));
}

bool PageRequests::is_given_up(PageKey page) const {
    const auto failure = failures_.find(page);
    return failure != failures_.end() && failure->second.for_good;
}

void PageRequests::forgive() { failures_.clear(); }

}  // namespace tessera
