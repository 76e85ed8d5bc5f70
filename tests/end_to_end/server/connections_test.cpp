// What connections may do and what they may not: crowds, leaving early, slowness, order, stopping.
#include <thread>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "tests/end_to_end/server/running_server.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using test::eventually;
using test::RawClient;
using test::Reply;
using test::RunningServer;

std::string request_for(const std::string& target, const std::string& fields = {}) {
    return "GET " + target + " HTTP/1.1\r\nHost: test\r\n" + fields + "\r\n";
}

double coalesced(RunningServer& running) {
    return running.server->pages().metrics().requests(PageResult::coalesced);
}

TEST(Connections, AThousandClientsWhoAskForOneColdPageCauseOneEvaluation) {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    ASSERT_GE(files.rlim_cur, 2200u) << "raise the limit of open files: ulimit -n 4096";
    RunningServer running;
    std::vector<RawClient> clients;
    for (int i = 0; i < 1000; ++i) {
        clients.push_back(running.client());
        ASSERT_TRUE(clients.back().connected());
        ASSERT_TRUE(clients.back().send(request_for(test::gated_page)));
    }
    ASSERT_TRUE(eventually([&] { return coalesced(running) == 999; }));
    running.gated->open();
    const Reply first = clients.front().receive().value();
    EXPECT_EQ(first.status, 200);
    for (std::size_t i = 1; i < clients.size(); ++i) {
        const auto reply = clients[i].receive();
        ASSERT_TRUE(reply.has_value());
        EXPECT_EQ(reply->body, first.body);
    }
    EXPECT_EQ(running.gated->begun, 1);
}

TEST(Connections, AClientThatLeavesStopsItsEvaluationAndDropsWhatIsQueued) {
    ServerOptions options = test::quick_options();
    options.pages.threads = 1;
    RunningServer running{options};
    RawClient running_page = running.client();
    running_page.send(request_for("/scenes/gated/20/1/1.png"));
    ASSERT_TRUE(eventually([&] { return running.gated->begun == 1; }));
    RawClient queued_page = running.client();
    queued_page.send(request_for("/scenes/gated/20/2/2.png"));
    ASSERT_TRUE(
        eventually([&] { return running.server->pages().metrics().requests(PageResult::evaluated) == 2; }));
    queued_page.close();
    ASSERT_TRUE(
        eventually([&] { return running.server->pages().metrics().requests(PageResult::cancelled) == 1; }));
    // Half of it is enough
    RawClient half = running.client();
    half.send(request_for("/scenes/gated/20/3/3.png"));
    half.close_sending();
    ASSERT_TRUE(
        eventually([&] { return running.server->pages().metrics().requests(PageResult::cancelled) == 2; }));
    EXPECT_FALSE(half.receive());
    running_page.close();
    EXPECT_TRUE(eventually([&] { return running.gated->stopped == 1; }));
    running.gated->open();
    EXPECT_EQ(running.client().get(test::gated_page)->status, 200);
    EXPECT_EQ(running.gated->begun, 2);  // the queued page never began
}

TEST(Connections, AFullQueueAnswersAtOnceThatItIsFull) {
    ServerOptions options = test::quick_options();
    options.pages.threads = 1;
    options.pages.queued_pages = 1;
    RunningServer running{options};
    RawClient first = running.client(), second = running.client();
    first.send(request_for("/scenes/gated/20/1/1.png"));
    ASSERT_TRUE(eventually([&] { return running.gated->begun == 1; }));
    second.send(request_for("/scenes/gated/20/2/2.png", "Priority: u=5\r\n"));
    ASSERT_TRUE(
        eventually([&] { return running.server->pages().metrics().requests(PageResult::evaluated) == 2; }));
    RawClient third = running.client();
    const Reply busy = third.get("/scenes/gated/20/3/3.png", "Priority: u=6, i\r\n").value();
    EXPECT_EQ(busy.status, 503);
    EXPECT_EQ(busy["retry-after"], "1");
    EXPECT_EQ(busy["cache-control"], "no-store");
    EXPECT_EQ(busy["etag"], "");
    EXPECT_EQ(third.get("/healthz")->status, 200);
    third.send(request_for("/scenes/gated/20/4/4.png", "Priority: u=1\r\n"));
    EXPECT_EQ(second.receive()->status, 503);  // made room for the urgent one
    running.gated->open();
    EXPECT_EQ(third.receive()->status, 200);
    EXPECT_EQ(first.receive()->status, 200);
}

TEST(Connections, APageThatTakesTooLongIsGivenUp) {
    ServerOptions options = test::quick_options();
    options.pages.deadline = 50ms;
    RunningServer running{options};
    RawClient client = running.client();
    const Reply late = client.get(test::gated_page).value();
    EXPECT_EQ(late.status, 503);
    EXPECT_EQ(late["cache-control"], "no-store");
    EXPECT_EQ(client.get("/healthz")->status, 200);
}

TEST(Connections, PipelinedRequestsAreAnsweredInOrder) {
    RunningServer running;
    RawClient client = running.client();
    client.send(request_for(test::gated_page) + request_for("/healthz"));
    ASSERT_TRUE(eventually([&] { return running.gated->begun == 1; }));
    client.send("\r\n" + request_for("/readyz") + request_for("/nothing"));  // read while the page is awaited
    std::this_thread::sleep_for(20ms);
    running.gated->open();
    EXPECT_EQ(client.receive()->fields["content-type"], "image/png");
    EXPECT_EQ(client.receive()->body, "alive\n");
    EXPECT_EQ(client.receive()->body, "ready\n");
    EXPECT_EQ(client.receive()->status, 404);
}

TEST(Connections, AByteAtATimeIsAsGoodAsAllAtOnce) {
    RunningServer running;
    RawClient client = running.client();
    for (const char c : request_for("/healthz")) {
        client.send({&c, 1});
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_EQ(client.receive()->status, 200);
}

TEST(Connections, EndWhenEitherSideSaysSo) {
    RunningServer running;
    RawClient closing = running.client();
    EXPECT_EQ(closing.get("/healthz", "Connection: close\r\n").value()["connection"], "close");
    EXPECT_TRUE(closing.is_closed());
    RawClient old = running.client();
    old.send("GET /healthz HTTP/1.0\r\n\r\n");
    EXPECT_EQ(old.receive().value()["connection"], "close");
    EXPECT_TRUE(old.is_closed());
    RawClient kept = running.client();
    for (int i = 0; i < 2; ++i) {
        kept.send("GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
        EXPECT_EQ(kept.receive().value()["connection"], "keep-alive");
    }
}

TEST(Connections, TooManyAreTurnedAway) {
    ServerOptions options = test::quick_options();
    options.max_connections = 2;
    RunningServer running{options};
    {
        RawClient one = running.client(), two = running.client();
        EXPECT_EQ(one.get("/healthz")->status, 200);
        EXPECT_EQ(two.get("/healthz")->status, 200);
        RawClient three = running.client();
        const Reply busy = three.receive().value();
        EXPECT_EQ(busy.status, 503);
        EXPECT_EQ(busy["retry-after"], "1");
        EXPECT_TRUE(three.is_closed());
    }
    EXPECT_TRUE(eventually([&] {
        const auto reply = running.client().get("/healthz");
        return reply && reply->status == 200;
    }));
}

TEST(Connections, ACrowdIsTurnedAwayAndForgotten) {
    ServerOptions options = test::quick_options();
    options.max_connections = 1;
    options.io_threads = 3;  // those turned away are not on the thread that accepts and counts them
    RunningServer running{options};
    RawClient inside = running.client();
    EXPECT_EQ(inside.get("/healthz")->status, 200);
    const auto told_of_a_crowd = [&] {
        std::vector<RawClient> crowd;
        for (int i = 0; i < 200; ++i) crowd.push_back(running.client());
        std::size_t told = 0;
        for (RawClient& client : crowd) {
            const auto busy = client.receive();
            if (busy && busy->status == 503) ++told;
            EXPECT_TRUE(client.is_closed());
        }
        return told;
    };
    EXPECT_GE(told_of_a_crowd(), 64u);
    EXPECT_TRUE(eventually([&] {
        std::this_thread::sleep_for(200ms);  // the answers linger a little
        return told_of_a_crowd() >= 64;
    })) << "the crowd before must not count";
    EXPECT_EQ(inside.get("/healthz")->status, 200);
}

TEST(Connections, SlowSendersAreToldAndSilentOnesAreNot) {
    ServerOptions options = test::quick_options();
    options.session.head_time = 100ms;
    options.session.idle_time = 2s;  // in which a slow machine, too, gets to send
    RunningServer running{options};
    RawClient slow = running.client(), silent = running.client();
    slow.send("GET /healthz HTTP/1.1\r\n");
    const Reply late = slow.receive().value();
    EXPECT_EQ(late.status, 408);
    EXPECT_EQ(late["connection"], "close");
    EXPECT_TRUE(slow.is_closed());
    EXPECT_FALSE(silent.receive().has_value());
    EXPECT_TRUE(silent.is_closed());
}

TEST(Connections, AReaderThatStopsReadingIsCutOff) {
    ServerOptions options = test::quick_options();
    options.session.write_time = 200ms;
    RunningServer running{options};
    RawClient reader{running.server->port(), 4096};
    std::string requests;
    for (int i = 0; i < 60; ++i) requests += request_for("/scenes/board/20/5/7.rgba");
    reader.send(requests);
    EXPECT_TRUE(eventually([&] { return running.server->metrics().connections.Value() == 0; }));
}

TEST(Connections, AStopFinishesWhatIsInFlightAndClosesWhatIsIdle) {
    RunningServer running;
    RawClient idle = running.client(), busy = running.client();
    EXPECT_EQ(idle.get("/healthz")->status, 200);
    busy.send(request_for(test::gated_page));
    ASSERT_TRUE(eventually([&] { return running.gated->begun == 1; }));
    std::thread stopping{[&] { running.server->stop(); }};
    EXPECT_TRUE(idle.is_closed());
    running.gated->open();
    const auto page = busy.receive();
    stopping.join();
    ASSERT_TRUE(page.has_value());
    EXPECT_EQ(page->status, 200);
    EXPECT_EQ(page->fields.at("connection"), "close");
    EXPECT_TRUE(busy.is_closed());
}

TEST(Connections, AStopWaitsNoLongerThanItsGrace) {
    ServerOptions options = test::quick_options();
    options.grace = 100ms;
    RunningServer running{options};
    RawClient busy = running.client();
    busy.send(request_for(test::gated_page));
    ASSERT_TRUE(eventually([&] { return running.gated->begun == 1; }));
    const auto begun = std::chrono::steady_clock::now();
    running.server->stop();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
    EXPECT_FALSE(busy.receive().has_value());
}

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) {
        return double(time.tv_sec) + double(time.tv_usec) * 1e-6;
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

TEST(Connections, RunningOutOfDescriptorsIsWaitedOutWithoutSpinning) {
    RunningServer running;
    RawClient first = running.client();
    ASSERT_EQ(first.get("/healthz")->status, 200);
    RawClient waiting;
    // UBSan looks at an object's type through a pipe, so it must have seen the logger while there were
    // descriptors
    spdlog::warn("{}, for {} ms", std::string{"taking every descriptor that is left"}, 300L);
    const int next = ::dup(0);
    ASSERT_GE(next, 0);
    ::close(next);
    rlimit before{};
    getrlimit(RLIMIT_NOFILE, &before);
    rlimit none_left = before;
    none_left.rlim_cur = static_cast<rlim_t>(next);
    setrlimit(RLIMIT_NOFILE, &none_left);
    waiting.connect(running.server->port());  // the kernel takes it, the server cannot
    waiting.send(request_for("/healthz"));
    const double cpu = cpu_seconds();
    std::this_thread::sleep_for(300ms);
    EXPECT_LT(cpu_seconds() - cpu, 0.15);
    EXPECT_EQ(first.get("/healthz")->status, 200);
    setrlimit(RLIMIT_NOFILE, &before);
    EXPECT_EQ(waiting.receive()->status, 200);
}

}  // namespace
}  // namespace tessera
