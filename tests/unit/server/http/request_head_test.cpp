#include "server/http/request_head.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(RequestHead, SplitsTheTarget) {
    RequestHead head;
    ASSERT_FALSE(head.parse("GET /a/b?c=d?e HTTP/1.1\r\nHost: h:1\r\n\r\n", {}).has_value());
    EXPECT_EQ(head.path, "/a/b");
    EXPECT_EQ(head.query, "c=d?e");
    EXPECT_EQ(head.host, "h:1");
    EXPECT_TRUE(head.keep_alive);
}

TEST(RequestHead, TheAbsoluteFormNamesTheHost) {
    RequestHead head;
    ASSERT_FALSE(head.parse("GET http://other:8080?x HTTP/1.1\r\nHost: h\r\n\r\n", {}).has_value());
    EXPECT_EQ(head.host, "other:8080");
    EXPECT_EQ(head.path, "/");
    EXPECT_EQ(head.query, "x");
}

TEST(RequestHead, KeepsOldClientsOnlyIfTheyAsk) {
    RequestHead plain, asking;
    ASSERT_FALSE(plain.parse("GET / HTTP/1.0\r\n\r\n", {}).has_value());
    EXPECT_FALSE(plain.keep_alive);
    EXPECT_EQ(plain.host, "localhost");
    ASSERT_FALSE(asking.parse("GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n", {}).has_value());
    EXPECT_TRUE(asking.keep_alive);
}

TEST(RequestHead, LimitsAreAsConfigured) {
    SessionLimits limits;
    limits.target_bytes = 8;
    limits.fields = 2;
    RequestHead head;
    EXPECT_FALSE(head.parse("GET /1234567 HTTP/1.1\r\nHost: h\r\n\r\n", limits).has_value());
    RequestHead long_target, many_fields;
    EXPECT_EQ(long_target.parse("GET /12345678 HTTP/1.1\r\nHost: h\r\n\r\n", limits)->status, 414u);
    EXPECT_EQ(many_fields.parse("GET / HTTP/1.1\r\nHost: h\r\nA: 1\r\nB: 2\r\n\r\n", limits)->status, 431u);
}

TEST(RequestHead, LetsABodyComeWhereOneBelongs) {
    const auto status = [](const std::string& text, const SessionLimits& limits = {}) {
        RequestHead head;
        const auto refusal = head.parse(text + "\r\n\r\n", limits);
        return refusal ? refusal->status : 0;
    };
    RequestHead head;
    ASSERT_FALSE(
        head.parse("POST /scenes/a/sample HTTP/1.1\r\nHost: h\r\nContent-Length: 12\r\nExpect: "
                   "100-Continue\r\n\r\n",
                   {}));
    EXPECT_EQ(head.body_bytes, 12u);
    EXPECT_TRUE(head.expects_continue);
    const std::string post = "POST /scenes/a/sample HTTP/1.1\r\nHost: h";
    EXPECT_EQ(status(post + "\r\nContent-Length: 0"), 0u);
    EXPECT_EQ(status(post), 411u);
    EXPECT_EQ(status(post + "\r\nTransfer-Encoding: chunked"), 411u);
    EXPECT_EQ(status(post + "\r\nContent-Length: 1\r\nTransfer-Encoding: chunked"), 400u);
    EXPECT_EQ(status(post + "\r\nContent-Length: 1\r\nContent-Length: 1"), 400u);
    EXPECT_EQ(status(post + "\r\nContent-Length: -1"), 400u);
    EXPECT_EQ(status(post + "\r\nContent-Length: 9999999999999999999999"), 400u);
    EXPECT_EQ(status(post + "\r\nContent-Length: 999999999999999999"), 413u);
    EXPECT_EQ(status(post + "\r\nContent-Length: 1\r\nExpect: cake"), 417u);
    SessionLimits limits;
    limits.body_bytes = 100;
    EXPECT_EQ(status(post + "\r\nContent-Length: 100", limits), 0u);
    EXPECT_EQ(status(post + "\r\nContent-Length: 101", limits), 413u);
    EXPECT_EQ(status("POST /scenes/a HTTP/1.1\r\nHost: h\r\nContent-Length: 1"), 405u);
    EXPECT_EQ(status("GET /scenes/a/sample HTTP/1.1\r\nHost: h\r\nContent-Length: 1"), 413u);
    EXPECT_EQ(status("PUT /scenes/a/sample HTTP/1.1\r\nHost: h\r\nContent-Length: 1"), 405u);
}

}  // namespace
}  // namespace tessera
