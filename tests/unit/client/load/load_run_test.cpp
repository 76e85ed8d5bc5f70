#include "client/load/load_run.h"

#include <csignal>
#include <mutex>

#include <gtest/gtest.h>

#include "tests/unit/client/link/small_server.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using test::SmallServer;
using Answer = SmallServer::Answer;

double ms(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

LoadPlan plan_for(const SmallServer& server) {
    LoadPlan plan;
    plan.server = server.address();
    plan.scene.id = "checker";
    plan.scene.extent.n = 10;
    plan.options.format = PageFormat::png;
    plan.connections = 8;
    plan.duration = 300ms;
    plan.timeout = 5s;
    return plan;
}

RandomWalk walk_of(std::size_t working_set = 0) {
    return {Extent{10}, parse_level_weights("", Extent{10}).value(), 1, working_set};
}

TEST(LoadRun, InAClosedLoopAsksAsFastAsTheServerAnswers) {
    SmallServer server{[](const SmallServer::Request&) {
        return Answer{.body = std::string(100, 'x'),
                      .fields = {{"Server-Timing", "cache;desc=hit, evaluate;dur=1"}},
                      .delay = 5ms};
    }};
    LoadPlan plan = plan_for(server);
    plan.stop_on_signals = true;  // and none comes
    RandomWalk walk = walk_of();
    const LoadOutcome outcome = run_load(plan, walk);
    const LoadTally& tally = outcome.tally;
    EXPECT_GT(tally.ok, 100u);  // 8 connections, 300 ms, 5 ms each: at most 480
    EXPECT_LE(tally.ok, 488u);
    EXPECT_EQ(tally.errors(), 0u) << tally.first_problem;
    EXPECT_EQ(tally.planned, tally.ok);
    EXPECT_EQ(tally.statuses.at(200), tally.ok);
    EXPECT_EQ(tally.cache_results.at("hit"), tally.ok);
    EXPECT_EQ(tally.body_bytes, 100 * tally.ok);
    EXPECT_GE(ms(tally.uncorrected.min()), 5);
    EXPECT_EQ(tally.corrected.count(), 0u);
    EXPECT_FALSE(outcome.interrupted);
    std::uint64_t of_levels = 0;
    for (const std::uint64_t pages : tally.pages_of_level) of_levels += pages;
    EXPECT_EQ(of_levels, tally.sent);
    EXPECT_EQ(server.connections(), 8);
}

// The server answers at once, but is frozen for 0.5 s of every 2 s. Requests planned evenly meet it frozen a
// quarter of the time, and then wait evenly between 0 and 500 ms: p90 is 300 ms, p99 480 ms. A tool that
// times from sending sees the 2 connections wait, once a freeze, and calls the p99 of 2,000 requests a
// millisecond.
TEST(LoadRun, InAnOpenLoopReportsWhatViewersOfAFrozenServerWait) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.body = "x"}; }};
    LoadPlan plan = plan_for(server);
    plan.rate = 1000;
    plan.connections = 2;
    plan.duration = 4s;
    RandomWalk walk = walk_of();
    server.freeze(500ms, 2000ms);
    const LoadTally tally = run_load(plan, walk).tally;
    EXPECT_EQ(tally.planned, 4000u);
    EXPECT_EQ(tally.ok, 4000u) << tally.first_problem;
    EXPECT_EQ(tally.corrected.count(), 4000u);
    EXPECT_NEAR(ms(tally.corrected.percentile(90)), 300, 40);
    EXPECT_NEAR(ms(tally.corrected.percentile(99)), 480, 40);
    EXPECT_NEAR(ms(tally.corrected.max()), 500, 60);
    EXPECT_LT(ms(tally.corrected.percentile(50)), 100);
    EXPECT_LT(ms(tally.uncorrected.percentile(99)), 100) << "the uncorrected figure shows what others hide";
    EXPECT_GT(ms(tally.uncorrected.max()), 400);
}

TEST(LoadRun, KeepsToItsRateAndLeavesOutTheWarmUp) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.body = "x"}; }};
    LoadPlan plan = plan_for(server);
    plan.rate = 400;
    plan.warmup = 250ms;
    plan.duration = 500ms;
    RandomWalk walk = walk_of();
    const LoadTally tally = run_load(plan, walk).tally;
    EXPECT_EQ(tally.planned, 200u);
    EXPECT_EQ(tally.lateness.count(), 200u);
    EXPECT_EQ(server.targets().size(), 300u);
    EXPECT_EQ(tally.measured, 500ms);
}

TEST(LoadRun, CountsWhatAServerThatNeverAnswersOwes) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.delay = 60s}; }};
    LoadPlan plan = plan_for(server);
    plan.rate = 100;
    plan.connections = 3;
    plan.drain = 200ms;
    RandomWalk walk = walk_of();
    const auto start = std::chrono::steady_clock::now();
    const LoadTally tally = run_load(plan, walk).tally;
    EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
    EXPECT_EQ(tally.planned, 30u);
    EXPECT_EQ(tally.sent, 3u);
    EXPECT_EQ(tally.unfinished, 30u);
    EXPECT_EQ(tally.errors(), 30u);
    EXPECT_EQ(tally.corrected.count(), 30u);
    EXPECT_NEAR(ms(tally.corrected.max()), 500, 50);  // the first, from its instant to the end of the drain
    EXPECT_NEAR(ms(tally.corrected.min()), 210, 50);
}

TEST(LoadRun, TellsShedPagesOtherStatusesTimeoutsAndLostConnectionsApart) {
    std::atomic<int> number = 0;
    SmallServer server{[&](const SmallServer::Request&) {
        switch (number++ % 4) {
            case 0:
                return Answer{.status = 503};
            case 1:
                return Answer{.status = 404};
            case 2:
                return Answer{.raw = "no HTTP at all\r\n\r\n"};
            default:
                return Answer{.delay = 10s};
        }
    }};
    LoadPlan plan = plan_for(server);
    plan.connections = 1;
    plan.timeout = 30ms;
    plan.drain = 30ms;
    RandomWalk walk = walk_of();
    const LoadTally tally = run_load(plan, walk).tally;
    EXPECT_EQ(tally.ok, 0u);
    EXPECT_GT(tally.shed, 0u);
    EXPECT_GT(tally.refused, 0u);
    EXPECT_GT(tally.lost, 0u);
    EXPECT_GT(tally.timeouts, 0u);
    EXPECT_EQ(tally.errors(), tally.planned);
    EXPECT_FALSE(tally.first_problem.empty());
    EXPECT_GE(ms(tally.uncorrected.min()), 30)
        << "a timeout counts as long as it took; quick refusals do not count as quick";
}

TEST(LoadRun, EndsInTimeAlthoughNobodyListens) {
    std::uint16_t port = 0;
    {
        SmallServer server{[](const SmallServer::Request&) { return Answer{}; }};
        port = server.address().port;
    }
    SmallServer unused{[](const SmallServer::Request&) { return Answer{}; }};
    for (const bool open_loop : {false, true}) {
        LoadPlan plan = plan_for(unused);
        plan.server.port = port;
        if (open_loop) plan.rate = 50;
        plan.drain = 100ms;
        RandomWalk walk = walk_of();
        const auto start = std::chrono::steady_clock::now();
        const LoadTally tally = run_load(plan, walk).tally;
        EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
        EXPECT_GT(tally.lost, 0u);
        EXPECT_LT(tally.lost, 200u) << "asks in a busy loop";
        EXPECT_EQ(tally.errors(), tally.planned);
        EXPECT_NE(tally.first_problem.find("is the server running"), std::string::npos);
    }
}

TEST(LoadRun, VerifiesThatAPageThatComesAgainIsTheSame) {
    std::atomic<int> number = 0;
    SmallServer server{[&](const SmallServer::Request& request) {
        const bool is_wrong = ++number == 200;
        return Answer{.body = is_wrong ? "wrong" : std::string{request.target()},
                      .fields = {{"ETag", "\"1\""}}};
    }};
    LoadPlan plan = plan_for(server);
    plan.verify = true;
    RandomWalk walk = walk_of(5);
    const LoadTally tally = run_load(plan, walk).tally;
    EXPECT_GT(tally.compared, 200u);
    EXPECT_GE(tally.mismatches, 1u);
    EXPECT_LE(tally.mismatches, 2u);  // as it goes wrong, and as it comes right again
    EXPECT_NE(tally.first_problem.find("other bytes"), std::string::npos);
}

TEST(LoadRun, StopsOnCtrlCWithTheFiguresSoFar) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.body = "x", .delay = 1ms}; }};
    for (const bool open_loop : {false, true}) {
        LoadPlan plan = plan_for(server);
        plan.duration = 60s;
        plan.stop_on_signals = true;
        plan.progress_every = 100ms;
        if (open_loop) plan.rate = 0.5;  // its next request is two seconds away
        RandomWalk walk = walk_of();
        int reports = 0;
        const auto start = std::chrono::steady_clock::now();
        const LoadOutcome outcome = run_load(plan, walk, [&](const LoadProgress& progress) {
            EXPECT_LE(progress.in_flight, 8u);
            if (++reports == 2) std::raise(SIGINT);
        });
        EXPECT_LT(std::chrono::steady_clock::now() - start, 1500ms);
        EXPECT_TRUE(outcome.interrupted);
        EXPECT_GT(outcome.tally.ok, 0u);
        EXPECT_EQ(outcome.tally.errors(), 0u);
        EXPECT_LT(ms(outcome.tally.measured), 1000);
        EXPECT_EQ(reports, 2);
    }
}

}  // namespace
}  // namespace tessera
