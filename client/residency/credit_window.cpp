#include "client/residency/credit_window.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tessera {
namespace {

constexpr std::size_t remembered = 24;  ///< Answers that estimates are made from: some windows' worth.
constexpr double headroom = 1.15;       ///< So that a link that has become faster is noticed.
constexpr std::size_t first_answers = 8;
/// A round trip that was measured longer ago is measured anew, with little under way: of a full link one sees
/// only the queue.
constexpr ClientTime round_trip_lasts{10000};

}  // namespace

CreditWindow::CreditWindow(std::size_t least, std::size_t most)
    : least_{std::min(least, most)}, most_{most} {}

void CreditWindow::sent(std::uint32_t id, ClientTime now, bool is_limited) {
    // After a pause the link's time begins with the request
    const ClientTime since = under_way_.empty() ? now : last_arrival_;
    under_way_[id] = {now, since, bytes_, is_limited, under_way_.size() <= least_};
}

/// The rate is that of Cardwell et al., "BBR: Congestion-Based Congestion Control", ACM Queue 14(5), 2016:
/// what was delivered between a request and its answer, over the longer of the times that sending and
/// arriving took. Samples of a link that had nothing to do say little, and count only if they are high.
void CreditWindow::arrived(std::uint32_t id, std::size_t bytes, ClientTime now) {
    const auto found = under_way_.find(id);
    if (found == under_way_.end()) return;
    const Sent sent = found->second;
    under_way_.erase(found);
    bytes_ += bytes;
    const auto size = static_cast<double>(bytes);
    page_bytes_ = page_bytes_ == 0 ? size : page_bytes_ + (size - page_bytes_) / 8;
    last_arrival_ = now;
    const ClientTime trip = std::max(now - sent.at, ClientTime{1});
    if (round_trip_.count() == 0 || trip <= round_trip_ || (sent.is_alone && is_draining_)) {
        round_trip_ = trip;
        round_trip_measured_ = now;
        is_draining_ = false;
    }
    const ClientTime took = std::max(now - std::min(sent.last_arrival, sent.at), ClientTime{1});
    const double rate = static_cast<double>(bytes_ - sent.bytes_before) / static_cast<double>(took.count());
    if (!sent.is_limited && rate <= bytes_per_second() / 1000) return;
    rates_.push_back(rate);
    if (rates_.size() > remembered) rates_.pop_front();
}

void CreditWindow::frame(ClientTime now) {
    if (last_frame_ >= ClientTime{0}) {
        const double took = std::clamp(static_cast<double>((now - last_frame_).count()), 1.0, 100.0);
        frame_ms_ += (took - frame_ms_) / 16;
    }
    last_frame_ = now;
    if (now - round_trip_measured_ > round_trip_lasts && round_trip_.count() > 0) is_draining_ = true;
}

std::size_t CreditWindow::answers() const {
    if (rates_.empty()) return std::clamp(first_answers, least_, most_);
    if (is_draining_) return least_;
    const double under_way =
        bytes_per_second() / 1000 * (static_cast<double>(round_trip().count()) + frame_ms_) * headroom;
    const auto pages =
        static_cast<std::size_t>(std::min(std::ceil(under_way / std::max(page_bytes_, 1.0)), 1e6));
    return std::clamp(pages + 1, least_, most_);
}

double CreditWindow::bytes_per_second() const {
    if (rates_.empty()) return 0;
    // What frames round is as often too high as too low
    std::vector<double> sorted(rates_.begin(), rates_.end());
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 3 / 4);
    std::ranges::nth_element(sorted, at);
    return *at * 1000;
}

}  // namespace tessera
