#include "client/residency/credit_window.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr std::size_t remembered = 24;  ///< Answers that estimates are made from: some windows' worth.
constexpr double headroom = 1.15;       ///< So that a link that has become faster is noticed.
constexpr std::size_t first_answers = 8;

}  // namespace

CreditWindow::CreditWindow(std::size_t least, std::size_t most)
    : least_{std::min(least, most)}, most_{most} {}

void CreditWindow::sent(std::uint32_t id, ClientTime now, bool is_limited) {
    // After a pause the link's time begins with the request
    const ClientTime since = under_way_.empty() ? now : last_arrival_;
    under_way_[id] = {now, since, bytes_, is_limited};
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
    round_trips_.push_back(std::max(now - sent.at, ClientTime{1}));
    if (round_trips_.size() > 4 * remembered) round_trips_.pop_front();
    const ClientTime took = std::max(now - std::min(sent.last_arrival, sent.at), ClientTime{1});
    const double rate = static_cast<double>(bytes_ - sent.bytes_before) / static_cast<double>(took.count());
    if (!sent.is_limited && !rates_.empty() && rate <= *std::ranges::max_element(rates_)) return;
    rates_.push_back(rate);
    if (rates_.size() > remembered) rates_.pop_front();
}

void CreditWindow::frame(ClientTime now) {
    if (last_frame_ >= ClientTime{0}) {
        const double took = std::clamp(static_cast<double>((now - last_frame_).count()), 1.0, 100.0);
        frame_ms_ += (took - frame_ms_) / 16;
    }
    last_frame_ = now;
}

std::size_t CreditWindow::answers() const {
    if (rates_.empty()) return std::clamp(first_answers, least_, most_);
    const double under_way =
        bytes_per_second() / 1000 * (static_cast<double>(round_trip().count()) + frame_ms_) * headroom;
    const auto pages =
        static_cast<std::size_t>(std::min(std::ceil(under_way / std::max(page_bytes_, 1.0)), 1e6));
    return std::clamp(pages + 1, least_, most_);
}

ClientTime CreditWindow::round_trip() const {
    return round_trips_.empty() ? ClientTime{0} : *std::ranges::min_element(round_trips_);
}

double CreditWindow::bytes_per_second() const {
    return rates_.empty() ? 0 : *std::ranges::max_element(rates_) * 1000;
}

}  // namespace tessera
