#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "client/residency/credit_window.h"
#include "client/residency/page_source.h"

namespace tessera {

/// A page that the view would gain from.
struct WantedPage {
    PageKey page;
    double gain = 0;  ///< Pixels covered × levels that are missing there: larger goes first.
    std::uint64_t least_revision = 0;  ///< See PageRequest, as what follows.
    Step step = 0;
    Urgency urgency = Urgency::sharpen;
    std::string have{};
};

struct RequestLimits {
    /// Pages under way at once, at most; how many below that, the measured link says (CreditWindow). Too few
    /// leave the connection idle while an answer travels; too many ask for pages that the view has left by
    /// the time they come (late binding beats any order of a long queue).
    std::size_t in_flight = 64;
    std::size_t least_in_flight = 4;
    /// Frames for which a page under way may be unwanted before it is cancelled.
    std::uint64_t frames_unwanted = 4;
    /// The wait after a failure; it doubles with each further one.
    ClientTime first_back_off{250};
    ClientTime longest_back_off{15000};
    /// A request that has no answer for so long is given up, and asked again if still wanted.
    ClientTime patience{60000};
};

/// Counts since the start.
struct RequestCounts {
    std::uint64_t requested = 0;
    std::uint64_t arrived = 0;    ///< With texels.
    std::uint64_t unchanged = 0;  ///< The copy at hand was right.
    std::uint64_t cancelled = 0;
    std::uint64_t failed = 0;
    std::uint64_t unasked = 0;  ///< Answers to no request, or to one answered before: dropped.
    std::uint64_t late = 0;     ///< Arrived although nobody had wanted them for some frames.
};

/// Asks for the most valuable pages, as many at once as the link carries; cancels what nobody wants any more;
/// after a failure leaves the page, and the whole source if it keeps failing, alone for a growing while. Of
/// one page, one version is under way at a time.
class PageRequests {
  public:
    PageRequests(PageSource& source, RequestLimits limits)
        : source_{source}, limits_{limits}, window_{limits.least_in_flight, limits.in_flight} {}

    /// Once a frame: all pages wanted now. A page that is under way is not asked for again.
    void want(std::vector<WantedPage> wanted, ClientTime now);

    /// Answers that came with texels or `unchanged`, at most `most`. Failures are dealt with here; the pages
    /// of which nothing will come are added to `without`.
    std::vector<ArrivedPage> take_arrived(std::size_t most, ClientTime now, std::vector<PageKey>* without);
    std::vector<ArrivedPage> take_arrived(std::size_t most, ClientTime now) {
        return take_arrived(most, now, nullptr);
    }

    /// Answers to requests that others made of the same source (StandIns), since the last call.
    std::vector<ArrivedPage> take_others() { return std::exchange(others_, {}); }

    std::size_t in_flight() const { return under_way_.size(); }
    /// How many more pages may be under way now.
    std::size_t room() const { return window_.answers() - std::min(window_.answers(), under_way_.size()); }
    bool is_under_way(PageKey page) const { return id_of_.contains(page); }
    const CreditWindow& window() const { return window_; }
    const RequestCounts& counts() const { return counts_; }
    /// The last failure's words while the source fails; empty once a page has come again.
    const std::string& problem() const { return problem_; }
    /// True: the server has no such page, and will not be asked for it again.
    bool is_given_up(PageKey page) const;
    /// What was given up may be there now: the scene is another.
    void forgive();

  private:
    struct UnderWay {
        PageKey page;
        std::uint64_t wanted_in_frame = 0;
        ClientTime sent{};
        bool cancelled = false;
    };
    struct Failure {
        int count = 0;
        ClientTime not_before{};
        bool for_good = false;
    };
    void cancel_unwanted(ClientTime now);
    void ask(std::vector<WantedPage> wanted, ClientTime now);
    void fail(PageKey page, const Error& error, ClientTime retry, ClientTime now);
    ClientTime back_off(int failures) const;

    PageSource& source_;
    RequestLimits limits_;
    CreditWindow window_;
    std::unordered_map<PageRequestId, UnderWay> under_way_;
    std::unordered_map<PageKey, PageRequestId> id_of_;
    std::unordered_map<PageKey, Failure> failures_;
    PageRequestId next_id_ = 1;
    std::size_t allowed_ = 0;
    int failures_in_a_row_ = 0;
    ClientTime resting_until_{};
    std::uint64_t frame_ = 0;
    std::vector<ArrivedPage> others_;
    RequestCounts counts_;
    std::string problem_;
};

}  // namespace tessera
