#include "client/link/page_client.h"

#include <map>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/unit/client/link/small_server.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using test::SmallServer;
using Answer = SmallServer::Answer;

constexpr std::size_t page_bytes = 4 * 256 * 256;

SceneInfo checker_info(std::uint8_t n = 10) {
    SceneInfo info;
    info.id = "checker";
    info.extent.n = n;
    info.max_gutter = 16;
    return info;
}

PageClientSettings quick_settings() {
    PageClientSettings settings;
    settings.first_back_off = 5ms;
    return settings;
}

/// Collects what a client answers.
struct Answers {
    std::map<RequestId, Result<PageReply>> all;
    PageClient::Completion collect() {
        return [this](RequestId id, Result<PageReply> result) {
            EXPECT_TRUE(all.emplace(id, std::move(result)).second) << "a request ended twice";
        };
    }
};

TEST(PageClient, FetchesPagesOverItsConnectionsAndUnpacksThem) {
    SmallServer server{[](const SmallServer::Request& request) {
        EXPECT_EQ(request["Accept-Encoding"], "zstd");
        const std::string content(page_bytes, request.target().back());
        std::string packed(ZSTD_compressBound(content.size()), '\0');
        packed.resize(ZSTD_compress(packed.data(), packed.size(), content.data(), content.size(), 1));
        return Answer{
            .body = packed, .fields = {{"Content-Encoding", "zstd"}, {"ETag", "\"7\""}}, .delay = 1ms};
    }};
    boost::asio::io_context context{1};
    PageClientSettings settings = quick_settings();
    settings.connections = 3;
    PageClient client{context.get_executor(), server.address(), checker_info(), settings};
    Answers answers;
    for (std::uint32_t x = 0; x < 12; ++x) client.get({.level = 1, .x = x, .y = 2}, {}, answers.collect());
    context.run();
    ASSERT_EQ(answers.all.size(), 12u);
    for (const auto& [id, result] : answers.all) {
        ASSERT_TRUE(result) << result.error().detail;
        EXPECT_EQ(result->bytes, std::string(page_bytes, 'a'));
        EXPECT_EQ(result->etag, "\"7\"");
        EXPECT_GT(result->took, 0us);
    }
    EXPECT_EQ(server.connections(), 3);
    EXPECT_THAT(server.targets(), ::testing::Contains("/scenes/checker/9/11/2.rgba"));
    const auto counts = client.statistics();
    EXPECT_EQ(counts.succeeded, 12u);
    EXPECT_EQ(counts.bytes_delivered, 12 * page_bytes);
    EXPECT_EQ(counts.waiting + counts.on_the_wire, 0u);
}

TEST(PageClient, TriesAgainWhenTheServerIsOverloadedAndWaitsAsLongAsItSays) {
    std::atomic<int> refusals = 2;
    SmallServer server{[&](const SmallServer::Request&) {
        if (refusals-- > 0) return Answer{.status = 503, .fields = {{"Retry-After", "1"}}};
        return Answer{.body = "png"};
    }};
    boost::asio::io_context context{1};
    PageClientSettings settings = quick_settings();
    settings.longest_back_off = 80ms;  // shorter than the second that the server asks for
    PageClient client{context.get_executor(), server.address(), checker_info(), settings};
    Answers answers;
    const auto start = std::chrono::steady_clock::now();
    const RequestId id = client.get({}, {.format = PageFormat::png}, answers.collect());
    context.run();
    EXPECT_EQ(answers.all.at(id).value().bytes, "png");
    EXPECT_GE(std::chrono::steady_clock::now() - start, 160ms);
    EXPECT_EQ(client.statistics().retried, 2u);
}

TEST(PageClient, GivesUpAfterItsAttempts) {
    SmallServer server{[&](const SmallServer::Request&) { return Answer{.status = 503}; }};
    boost::asio::io_context context{1};
    PageClient client{context.get_executor(), server.address(), checker_info(), quick_settings()};
    Answers answers;
    const RequestId id = client.get({}, {}, answers.collect());
    context.run();
    EXPECT_EQ(answers.all.at(id).error().code, ErrorCode::overloaded);
    EXPECT_EQ(server.targets().size(), 4u);
}

TEST(PageClient, TurnsStatusesIntoWhatTheCallerDoesNext) {
    std::atomic<unsigned> status = 0;
    SmallServer server{[&](const SmallServer::Request&) { return Answer{.status = status}; }};
    const auto code_for = [&](unsigned s) {
        status = s;
        boost::asio::io_context context{1};
        PageClient client{context.get_executor(), server.address(), checker_info(), quick_settings()};
        Answers answers;
        client.get({}, {}, answers.collect());
        context.run();
        return answers.all.begin()->second.error().code;
    };
    EXPECT_EQ(code_for(400), ErrorCode::malformed_request);
    EXPECT_EQ(code_for(404), ErrorCode::no_such_page);
    EXPECT_EQ(code_for(410), ErrorCode::page_changed);
    EXPECT_EQ(code_for(500), ErrorCode::io_failure);
    EXPECT_EQ(code_for(200), ErrorCode::io_failure);  // an empty body is no raw page
}

TEST(PageClient, RefusesWhatTheServerWouldAnywayWithoutAskingIt) {
    SmallServer server{[&](const SmallServer::Request&) { return Answer{}; }};
    boost::asio::io_context context{1};
    PageClientSettings settings = quick_settings();
    settings.connections = 1;
    settings.max_queued = 2;
    PageClient client{context.get_executor(), server.address(), checker_info(2), settings};
    Answers answers;
    const RequestId outside = client.get({.level = 1, .x = 2, .y = 0}, {}, answers.collect());
    const RequestId wide = client.get({}, {.gutter = 17}, answers.collect());
    client.get({}, {.format = PageFormat::png}, answers.collect());
    client.get({}, {.format = PageFormat::png}, answers.collect());
    const RequestId too_many = client.get({}, {.format = PageFormat::png}, answers.collect());
    EXPECT_TRUE(answers.all.empty()) << "completions never run within get()";
    context.run();
    EXPECT_EQ(answers.all.at(outside).error().code, ErrorCode::no_such_page);
    EXPECT_EQ(answers.all.at(wide).error().code, ErrorCode::malformed_request);
    EXPECT_EQ(answers.all.at(too_many).error().code, ErrorCode::overloaded);
    EXPECT_EQ(server.targets().size(), 2u);
}

TEST(PageClient, CancelsWaitingRequestsUnsentAndHangsUpOnSlowOnes) {
    SmallServer server{[&](const SmallServer::Request&) { return Answer{.body = "png", .delay = 150ms}; }};
    boost::asio::io_context context{1};
    PageClientSettings settings = quick_settings();
    settings.connections = 1;
    PageClient client{context.get_executor(), server.address(), checker_info(), settings};
    Answers answers;
    const FetchOptions png{.format = PageFormat::png};
    const RequestId slow = client.get({.x = 1}, png, answers.collect());
    const RequestId waiting = client.get({.x = 2}, png, answers.collect());
    const RequestId wanted = client.get({.x = 3}, png, answers.collect());
    boost::asio::steady_timer timer{context, 40ms};
    timer.async_wait([&](boost::system::error_code) {
        client.cancel(slow);
        client.cancel(waiting);
        client.cancel(waiting);  // a second time changes nothing
        client.cancel(99);
    });
    context.run();
    EXPECT_EQ(answers.all.at(slow).error().code, ErrorCode::cancelled);
    EXPECT_EQ(answers.all.at(waiting).error().code, ErrorCode::cancelled);
    EXPECT_TRUE(answers.all.at(wanted));
    EXPECT_EQ(server.targets().size(), 2u);
    EXPECT_EQ(server.hung_up_early(), 1);
    EXPECT_EQ(client.statistics().cancelled, 2u);
}

TEST(PageClient, LetsACancelledAnswerArriveIfItIsNearlyHere) {
    SmallServer server{[&](const SmallServer::Request&) { return Answer{.body = "png", .delay = 30ms}; }};
    boost::asio::io_context context{1};
    PageClientSettings settings = quick_settings();
    settings.connections = 1;
    settings.cancel_grace = 500ms;
    PageClient client{context.get_executor(), server.address(), checker_info(), settings};
    Answers answers;
    const RequestId id = client.get({}, {.format = PageFormat::png}, answers.collect());
    boost::asio::steady_timer timer{context, 10ms};
    timer.async_wait([&](boost::system::error_code) {
        client.cancel(id);
        client.get({.x = 1}, {.format = PageFormat::png}, answers.collect());
    });
    context.run();
    EXPECT_EQ(answers.all.size(), 2u);
    EXPECT_EQ(server.connections(), 1);
}

TEST(PageClient, MayBeDestroyedWhileRequestsAreUnderWay) {
    SmallServer server{[&](const SmallServer::Request&) { return Answer{.delay = 10s}; }};
    boost::asio::io_context context{1};
    Answers answers;
    {
        PageClient client{context.get_executor(), server.address(), checker_info(), quick_settings()};
        for (std::uint32_t x = 0; x < 20; ++x) client.get({.x = x}, {}, answers.collect());
        context.run_for(30ms);
    }
    context.restart();
    context.run_for(2s);
    EXPECT_TRUE(context.stopped()) << "something is still under way";
    EXPECT_TRUE(answers.all.empty());
}

}  // namespace
}  // namespace tessera
