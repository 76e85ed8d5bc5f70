#include "client/load/load_run.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <ctime>
#include <memory>
#include <vector>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "client/link/http_connection.h"
#include "client/load/body_check.h"

namespace tessera {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
constexpr auto as_result = asio::as_tuple(asio::use_awaitable);

double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// What the server says about where the page came from: the description of Server-Timing's entry `cache`, or
/// what proxies say. Empty if it says nothing.
std::string_view cache_result(const HttpReply& reply) {
    constexpr std::string_view entry = "cache;desc=";
    const std::string_view timing = reply.field("Server-Timing");
    if (const auto at = timing.find(entry); at != std::string_view::npos) {
        const std::string_view value = timing.substr(at + entry.size());
        return value.substr(0, value.find_first_of(",; "));
    }
    for (const std::string_view name : {"Cache-Status", "X-Cache"})
        if (const auto value = reply.field(name); !value.empty()) return value.substr(0, 60);
    return {};
}

class Run {
  public:
    Run(const LoadPlan& plan, PageWalk& walk, const std::function<void(const LoadProgress&)>& report)
        : plan_{plan}, walk_{walk}, report_{report} {
        HttpLimits limits;
        limits.connect_timeout = limits.request_timeout = plan_.timeout;
        for (std::size_t i = 0; i < plan_.connections; ++i)
            lines_.push_back(std::make_unique<Line>(context_, plan_.server, limits));
        if (plan_.accept_zstd) fields_.set("Accept-Encoding", "zstd");
        tally_.open_loop = plan_.rate.has_value();
        tally_.verified = plan_.verify;
    }

    LoadOutcome run();

  private:
    struct Line {
        Line(asio::io_context& context, const ServerAddress& server, const HttpLimits& limits)
            : connection{context.get_executor(), server, limits}, timer{context} {}
        HttpConnection connection;
        asio::steady_timer timer;
        std::optional<Clock::time_point> planned{};  ///< Of the measured request on the wire.
    };

    asio::awaitable<void> work(Line& line);
    void count(const HttpReply& reply, const std::string& target, nanoseconds corrected,
               nanoseconds uncorrected);
    void count(const Error& error, nanoseconds corrected, nanoseconds uncorrected);
    void compare(const HttpReply& reply, const std::string& target);
    void problem(const std::string& text) {
        if (tally_.first_problem.empty()) tally_.first_problem = text;
    }

    Clock::time_point instant_of(std::uint64_t slot) const {
        return start_ + nanoseconds{std::llround(static_cast<double>(slot) * 1e9 / *plan_.rate)};
    }
    bool is_measured(Clock::time_point instant) const { return instant >= begin_ && instant < end_; }
    void set_end(Clock::time_point end, nanoseconds drain);
    void give_up();
    void line_ended();
    void account_for_the_unsent();
    asio::awaitable<void> report_progress();

    const LoadPlan& plan_;
    PageWalk& walk_;
    const std::function<void(const LoadProgress&)>& report_;
    asio::io_context context_{1};
    asio::signal_set signals_{context_};
    asio::steady_timer deadline_{context_};
    asio::steady_timer tick_{context_};
    std::vector<std::unique_ptr<Line>> lines_;
    HttpFields fields_;
    BodyCheck bodies_;
    LoadTally tally_;
    LatencyHistogram recent_;
    std::uint64_t recent_pages_ = 0, recent_bytes_ = 0, recent_errors_ = 0;
    Clock::time_point start_{}, begin_{}, end_{};
    std::uint64_t next_slot_ = 0;
    std::size_t working_ = 0, in_flight_ = 0;
    bool interrupted_ = false, given_up_ = false;
};

LoadOutcome Run::run() {
    const double processor_before = processor_seconds();
    start_ = Clock::now();
    begin_ = start_ + plan_.warmup;
    set_end(begin_ + plan_.duration, plan_.drain);
    if (plan_.stop_on_signals) {
        signals_.add(SIGINT);
        signals_.add(SIGTERM);
        signals_.async_wait([this](boost::system::error_code error, int) {
            if (error) return;
            interrupted_ = true;
            signals_.clear();  // a second Ctrl-C ends the process at once
            set_end(std::min(end_, Clock::now()),
                    std::min<nanoseconds>(plan_.drain, std::chrono::seconds{1}));
            for (const auto& line : lines_) line->timer.cancel();
        });
    }
    const auto rethrow = [](const std::exception_ptr& failure) {
        if (failure) std::rethrow_exception(failure);  // a bug: errors are values
    };
    for (const auto& line : lines_) {
        ++working_;
        asio::co_spawn(context_, work(*line), rethrow);
    }
    if (report_ && plan_.progress_every.count() > 0) asio::co_spawn(context_, report_progress(), rethrow);
    context_.run();

    account_for_the_unsent();
    tally_.measured = std::max(nanoseconds{0}, end_ - begin_);
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    return {std::move(tally_), interrupted_,
            (processor_seconds() - processor_before) / std::max(seconds, 1e-9)};
}

void Run::set_end(Clock::time_point end, nanoseconds drain) {
    end_ = end;
    deadline_.expires_at(end + drain);
    deadline_.async_wait([this](boost::system::error_code error) {
        if (!error) give_up();
    });
}

void Run::give_up() {
    given_up_ = true;
    for (const auto& line : lines_) {
        line->timer.cancel();
        line->connection.close();
    }
}

void Run::line_ended() {
    if (--working_ > 0) return;
    deadline_.cancel();
    tick_.cancel();
    signals_.cancel();
}

/// One connection's work from start to end.
asio::awaitable<void> Run::work(Line& line) {
    milliseconds pause{20};
    while (!given_up_) {
        // Take the next planned instant, and wait for it
        const Clock::time_point free_since = Clock::now();
        const Clock::time_point planned = plan_.rate ? instant_of(next_slot_) : free_since;
        if (planned >= end_) break;
        ++next_slot_;
        if (planned > free_since) {
            line.timer.expires_at(planned);
            co_await line.timer.async_wait(as_result);
            if (planned >= end_ || given_up_) break;  // the end has moved meanwhile
        }

        // Ask
        const Clock::time_point sent = Clock::now();
        const bool measured = is_measured(planned);
        const PageKey page = walk_.next();
        const std::string target = page_target(plan_.scene.id, plan_.scene.extent, page, plan_.options);
        if (measured) {
            ++tally_.sent;
            ++tally_.pages_of_level[page.level];
            if (plan_.rate) tally_.lateness.record(sent - std::max(planned, free_since));
            line.planned = planned;
        }
        ++in_flight_;
        const Result<HttpReply> reply = co_await line.connection.get(target, fields_);
        --in_flight_;
        const Clock::time_point arrived = Clock::now();

        // Count
        if (!reply && reply.error().code == ErrorCode::cancelled)
            break;  // we gave up: it stays in line.planned
        line.planned.reset();
        if (reply && reply->status == 200) {
            recent_.record(arrived - (plan_.rate ? planned : sent));
            ++recent_pages_;
            recent_bytes_ += reply->body.size();
        } else {
            ++recent_errors_;
        }
        if (measured && reply && reply->status == 200) tally_.until_last_page = arrived - begin_;
        if (measured && reply) count(*reply, target, arrived - planned, arrived - sent);
        if (measured && !reply) count(reply.error(), arrived - planned, arrived - sent);

        // A server that is gone is not asked in a busy loop
        if (!reply && reply.error().code == ErrorCode::io_failure) {
            line.timer.expires_at(std::min(Clock::now() + pause, std::max(end_, Clock::now())));
            co_await line.timer.async_wait(as_result);
            pause = std::min(2 * pause, milliseconds{1000});
        } else {
            pause = milliseconds{20};
        }
    }
    line_ended();
}

void Run::count(const HttpReply& reply, const std::string& target, nanoseconds corrected,
                nanoseconds uncorrected) {
    ++tally_.statuses[reply.status];
    if (reply.status == 503 || reply.status == 429) {
        ++tally_.shed;
    } else if (reply.status != 200) {
        ++tally_.refused;
    } else {
        ++tally_.ok;
        tally_.body_bytes += reply.body.size();
        if (plan_.rate) tally_.corrected.record(corrected);
        tally_.uncorrected.record(uncorrected);
        if (const auto result = cache_result(reply); !result.empty()) {
            const bool is_known = tally_.cache_results.contains(std::string{result});
            ++tally_.cache_results[is_known || tally_.cache_results.size() < 15 ? std::string{result}
                                                                                : "other"];
        }
        if (plan_.verify) compare(reply, target);
        return;
    }
    problem(target + ": status " + std::to_string(reply.status));
}

void Run::count(const Error& error, nanoseconds corrected, nanoseconds uncorrected) {
    problem(error.detail);
    if (error.code == ErrorCode::timed_out) {
        ++tally_.timeouts;
        if (plan_.rate) tally_.corrected.record(corrected);
        tally_.uncorrected.record(uncorrected);
    } else {
        ++tally_.lost;
    }
}

void Run::compare(const HttpReply& reply, const std::string& target) {
    const auto verdict = bodies_.compare(target, reply.field("ETag"), reply.body);
    if (verdict == BodyCheck::Verdict::no_room) tally_.forgetful = true;
    if (verdict == BodyCheck::Verdict::no_room || verdict == BodyCheck::Verdict::first_seen) return;
    ++tally_.compared;
    if (verdict == BodyCheck::Verdict::mismatch) {
        ++tally_.mismatches;
        problem(target + ": other bytes than before under the same ETag");
    }
    if (verdict == BodyCheck::Verdict::changed) ++tally_.changed;
    if (verdict == BodyCheck::Verdict::retagged) ++tally_.retagged;
}

/// What was planned and has no answer has waited at least until now.
void Run::account_for_the_unsent() {
    const Clock::time_point now = Clock::now();
    for (const auto& line : lines_) {
        if (!line->planned) continue;
        ++tally_.unfinished;
        if (plan_.rate) tally_.corrected.record(now - *line->planned);
    }
    tally_.planned = tally_.sent;
    if (!plan_.rate) return;
    for (; instant_of(next_slot_) < end_; ++next_slot_) {
        if (!is_measured(instant_of(next_slot_))) continue;
        ++tally_.planned;
        ++tally_.unfinished;
        tally_.corrected.record(now - instant_of(next_slot_));
    }
}

asio::awaitable<void> Run::report_progress() {
    Clock::time_point last = start_;
    while (working_ > 0) {
        tick_.expires_after(plan_.progress_every);
        co_await tick_.async_wait(as_result);
        if (working_ == 0) co_return;
        const Clock::time_point now = Clock::now();
        std::uint64_t backlog = 0;
        if (plan_.rate) {
            const double due =
                std::chrono::duration<double>(std::min(now, end_) - start_).count() * *plan_.rate;
            backlog = static_cast<std::uint64_t>(std::max(0.0, due - static_cast<double>(next_slot_)));
        }
        report_({now - start_, end_ - start_, now < begin_, now >= end_, now - last, recent_pages_,
                 recent_bytes_, recent_errors_, recent_, in_flight_, backlog, tally_});
        recent_.clear();
        recent_pages_ = recent_bytes_ = recent_errors_ = 0;
        last = now;
    }
}

}  // namespace

LoadOutcome run_load(const LoadPlan& plan, PageWalk& walk,
                     const std::function<void(const LoadProgress&)>& report) {
    return Run{plan, walk, report}.run();
}

}  // namespace tessera
