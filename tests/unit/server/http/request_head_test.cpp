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

}  // namespace
}  // namespace tessera
