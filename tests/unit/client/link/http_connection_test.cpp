#include "client/link/http_connection.h"

#include <future>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include "tests/unit/client/link/small_server.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using test::SmallServer;
using Answer = SmallServer::Answer;

/// Runs one GET to its end.
Result<HttpReply> get(boost::asio::io_context& context, HttpConnection& connection, std::string_view target) {
    auto reply = boost::asio::co_spawn(context, connection.get(target), boost::asio::use_future);
    context.restart();
    context.run();
    return reply.get();
}

Result<HttpReply> get_once(const SmallServer& server, HttpLimits limits = {}) {
    boost::asio::io_context context{1};
    HttpConnection connection{context.get_executor(), server.address(), limits};
    return get(context, connection, "/");
}

TEST(HttpConnection, KeepsItsConnectionFromOneRequestToTheNext) {
    SmallServer server{[](const SmallServer::Request& request) {
        EXPECT_EQ(request["Host"].substr(0, 9), "127.0.0.1");
        return Answer{.status = 418, .body = std::string{request.target()}, .fields = {{"ETag", "\"a\""}}};
    }};
    boost::asio::io_context context{1};
    HttpConnection connection{context.get_executor(), server.address()};
    for (const char* target : {"/a", "/b", "/c"}) {
        const auto reply = get(context, connection, target);
        ASSERT_TRUE(reply) << reply.error().detail;
        EXPECT_EQ(reply->status, 418u);
        EXPECT_EQ(reply->body, target);
        EXPECT_EQ(reply->field("etag"), "\"a\"");
        EXPECT_EQ(reply->field("absent"), "");
    }
    EXPECT_EQ(server.connections(), 1);
    EXPECT_GT(connection.bytes_received(), 3u * 40);
}

TEST(HttpConnection, OpensAnotherAfterTheServerClosedItWhileIdle) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.body = "x", .close_after = true}; }};
    boost::asio::io_context context{1};
    HttpConnection connection{context.get_executor(), server.address()};
    for (int i = 0; i < 3; ++i) {
        const auto reply = get(context, connection, "/");
        ASSERT_TRUE(reply) << reply.error().detail;
    }
    EXPECT_EQ(server.connections(), 3);
    EXPECT_EQ(connection.opened(), 3u);
}

TEST(HttpConnection, HonoursConnectionClose) {
    SmallServer server{[](const SmallServer::Request&) {
        return Answer{.fields = {{"Connection", "close"}}};
    }};
    boost::asio::io_context context{1};
    HttpConnection connection{context.get_executor(), server.address()};
    ASSERT_TRUE(get(context, connection, "/"));
    EXPECT_FALSE(connection.is_open());
}

TEST(HttpConnection, GivesUpAfterItsTimeout) {
    SmallServer server{[](const SmallServer::Request&) { return Answer{.delay = 5s}; }};
    HttpLimits limits;
    limits.request_timeout = 50ms;
    const auto reply = get_once(server, limits);
    ASSERT_FALSE(reply);
    EXPECT_EQ(reply.error().code, ErrorCode::timed_out);
}

TEST(HttpConnection, RefusesAnswersBeyondItsLimits) {
    SmallServer long_body{[](const SmallServer::Request&) { return Answer{.body = std::string(5000, 'x')}; }};
    SmallServer long_header{[](const SmallServer::Request&) {
        return Answer{.fields = {{"X-Long", std::string(5000, 'x')}}};
    }};
    SmallServer endless_body{[](const SmallServer::Request&) {
        return Answer{.raw = "HTTP/1.1 200 OK\r\n\r\n" + std::string(5000, 'x')};
    }};
    HttpLimits limits;
    limits.body_bytes = 1000;
    limits.header_bytes = 1000;
    for (const SmallServer* server : {&long_body, &long_header, &endless_body}) {
        const auto reply = get_once(*server, limits);
        ASSERT_FALSE(reply);
        EXPECT_EQ(reply.error().code, ErrorCode::io_failure);
        EXPECT_NE(reply.error().detail.find("longer than the limit"), std::string::npos)
            << reply.error().detail;
    }
}

TEST(HttpConnection, ReportsWhatIsNotHttpAndWhatEndsTooEarly) {
    for (const char* raw : {"SSH-2.0-OpenSSH\r\n\r\n", "HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\nabc"}) {
        SmallServer server{[&](const SmallServer::Request&) { return Answer{.raw = raw}; }};
        const auto reply = get_once(server);
        ASSERT_FALSE(reply);
        EXPECT_EQ(reply.error().code, ErrorCode::io_failure);
    }
}

TEST(HttpConnection, EndsWithCancelledWhenItIsClosedAndWorksAgainAfterwards) {
    SmallServer server{[](const SmallServer::Request& request) {
        return Answer{.delay = request.target() == "/slow" ? 300ms : 0ms};
    }};
    boost::asio::io_context context{1};
    HttpConnection connection{context.get_executor(), server.address()};
    boost::asio::steady_timer timer{context, 30ms};
    timer.async_wait([&](boost::system::error_code) { connection.close(); });
    const auto start = std::chrono::steady_clock::now();
    const auto reply = get(context, connection, "/slow");
    EXPECT_LT(std::chrono::steady_clock::now() - start, 250ms);
    ASSERT_FALSE(reply);
    EXPECT_EQ(reply.error().code, ErrorCode::cancelled);
    EXPECT_TRUE(get(context, connection, "/quick"));
}

}  // namespace
}  // namespace tessera
