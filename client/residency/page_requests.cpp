#include "client/residency/page_requests.h"

#include <algorithm>
#include <tuple>

namespace tessera {
namespace {

constexpr std::size_t most_failures_remembered = 4096;
constexpr int failures_before_rest = 3;  ///< In a row: then it is the server, not a page.

}  // namespace

void PageRequests::want(std::vector<WantedPage> wanted, ClientTime now) {
    ++frame_;
    for (const WantedPage& want : wanted)
        if (const auto found = under_way_.find(want.page); found != under_way_.end())
            found->second.wanted_in_frame = frame_;

    for (auto& [page, state] : under_way_) {
        if (state.cancelled || state.wanted_in_frame + limits_.frames_unwanted >= frame_) continue;
        state.cancelled = true;
        source_.cancel(page);
    }

    if (now < resting_until_) return;
    // While the source keeps failing, one request at a time finds out whether it is back
    const std::size_t most = failures_in_a_row_ >= failures_before_rest ? 1 : limits_.in_flight;
    if (under_way_.size() >= most) return;
    std::erase_if(wanted, [&](const WantedPage& want) {
        if (under_way_.contains(want.page)) return true;
        const auto failure = failures_.find(want.page);
        return failure != failures_.end() && (failure->second.for_good || now < failure->second.not_before);
    });
    const auto more_valuable = [](const WantedPage& a, const WantedPage& b) {
        return std::tie(b.gain, b.page.level, a.page) < std::tie(a.gain, a.page.level, b.page);
    };
    const std::size_t starting = std::min(wanted.size(), most - under_way_.size());
    std::partial_sort(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(starting), wanted.end(),
                      more_valuable);
    for (std::size_t i = 0; i < starting; ++i) {
        if (!source_.request(wanted[i].page)) return;
        under_way_[wanted[i].page] = {frame_, false};
        ++counts_.requested;
    }
}

std::vector<ArrivedPage> PageRequests::take_arrived(std::size_t most, ClientTime now) {
    std::vector<ArrivedPage> arrived = source_.take_arrived(most);
    std::erase_if(arrived, [&](const ArrivedPage& page) {
        const auto found = under_way_.find(page.page);
        if (found == under_way_.end()) return true;  // not asked for: a broken source
        const bool cancelled = found->second.cancelled;
        under_way_.erase(found);
        if (page.texels && page.texels->size() == slot_bytes) {
            failures_.erase(page.page);
            failures_in_a_row_ = 0;
            problem_.clear();
            ++counts_.arrived;
            return false;
        }
        if (page.texels) {
            fail(page.page,
                 {ErrorCode::io_failure, "a page of " + std::to_string(page.texels->size()) +
                                             " bytes arrived, not of " + std::to_string(slot_bytes)},
                 now);
        } else if (cancelled || page.texels.error().code == ErrorCode::cancelled) {
            ++counts_.cancelled;
        } else {
            fail(page.page, page.texels.error(), now);
        }
        return true;
    });
    return arrived;
}

void PageRequests::fail(PageKey page, const Error& error, ClientTime now) {
    ++counts_.failed;
    problem_ = error.detail;
    if (failures_.size() >= most_failures_remembered) failures_.clear();
    Failure& failure = failures_[page];
    ++failure.count;
    failure.not_before = now + back_off(failure.count);
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

}  // namespace tessera
