#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/residency/page_source.h"

namespace tessera {

/// Time since the client started; the caller's clock, so that tests can turn it.
using ClientTime = std::chrono::milliseconds;

/// A page that the view would gain from.
struct WantedPage {
    PageKey page;
    double gain = 0;  ///< Pixels covered × levels that are missing there: larger goes first.
};

struct RequestLimits {
    /// Pages under way at once. Too few leave the connection idle while an answer travels; too many ask for
    /// pages that the view has left by the time they come (late binding beats any order of a long queue).
    std::size_t in_flight = 16;
    /// Frames for which a page under way may be unwanted before it is cancelled.
    std::uint64_t frames_unwanted = 4;
    /// The wait after a failure; it doubles with each further one.
    ClientTime first_back_off{250};
    ClientTime longest_back_off{15000};
};

/// Counts since the start.
struct RequestCounts {
    std::uint64_t requested = 0;
    std::uint64_t arrived = 0;
    std::uint64_t cancelled = 0;
    std::uint64_t failed = 0;
};

/// Asks for the most valuable pages, so many at once; cancels what nobody wants any more; after a failure
/// leaves the page, and the whole source if it keeps failing, alone for a growing while.
class PageRequests {
  public:
    PageRequests(PageSource& source, RequestLimits limits) : source_{source}, limits_{limits} {}

    /// Once a frame: all pages wanted now. A page that is under way is not asked for again.
    void want(std::vector<WantedPage> wanted, ClientTime now);

    /// Texels that came, at most `most`. Failures are dealt with here.
    std::vector<ArrivedPage> take_arrived(std::size_t most, ClientTime now);

    std::size_t in_flight() const { return under_way_.size(); }
    bool is_under_way(PageKey page) const { return under_way_.contains(page); }
    const RequestCounts& counts() const { return counts_; }
    /// The last failure's words while the source fails; empty once a page has come again.
    const std::string& problem() const { return problem_; }
    /// True: the server has no such page, and will not be asked for it again.
    bool is_given_up(PageKey page) const;

  private:
    struct UnderWay {
        std::uint64_t wanted_in_frame = 0;
        bool cancelled = false;
    };
    struct Failure {
        int count = 0;
        ClientTime not_before{};
        bool for_good = false;
    };
    void fail(PageKey page, const Error& error, ClientTime now);
    ClientTime back_off(int failures) const;

    PageSource& source_;
    RequestLimits limits_;
    std::unordered_map<PageKey, UnderWay> under_way_;
    std::unordered_map<PageKey, Failure> failures_;
    int failures_in_a_row_ = 0;
    ClientTime resting_until_{};
    std::uint64_t frame_ = 0;
    RequestCounts counts_;
    std::string problem_;
};

}  // namespace tessera
