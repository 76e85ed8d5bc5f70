#include "client/link/server_address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using ::testing::HasSubstr;

TEST(ServerAddress, ReadsHostAndPort) {
    EXPECT_EQ(parse_server_address("http://127.0.0.1:7070").value(), (ServerAddress{"127.0.0.1", 7070}));
    EXPECT_EQ(parse_server_address("http://tiles.example/").value(), (ServerAddress{"tiles.example", 80}));
    EXPECT_EQ(parse_server_address("localhost:7070").value(), (ServerAddress{"localhost", 7070}));
    EXPECT_EQ(parse_server_address("http://[::1]:8080").value(), (ServerAddress{"::1", 8080}));
}

TEST(ServerAddress, WritesItsAuthorityAsTheHostFieldWantsIt) {
    EXPECT_EQ((ServerAddress{"localhost", 80}.authority()), "localhost");
    EXPECT_EQ((ServerAddress{"localhost", 7070}.authority()), "localhost:7070");
    EXPECT_EQ((ServerAddress{"::1", 7070}.url()), "http://[::1]:7070");
}

TEST(ServerAddress, SaysWhatIsWrongWithAUrl) {
    const auto problem = [](std::string_view url) {
        const auto parsed = parse_server_address(url);
        EXPECT_FALSE(parsed) << url;
        if (parsed) return std::string{};
        EXPECT_EQ(parsed.error().code, ErrorCode::invalid_input);
        return parsed.error().detail;
    };
    EXPECT_THAT(problem("https://host"), HasSubstr("https"));
    EXPECT_THAT(problem("ftp://host"), HasSubstr("scheme"));
    EXPECT_THAT(problem("http://host/scenes"), HasSubstr("leave out"));
    EXPECT_THAT(problem("http://me@host"), HasSubstr("user"));
    EXPECT_THAT(problem("http://"), HasSubstr("host is missing"));
    EXPECT_THAT(problem(""), HasSubstr("host is missing"));
    EXPECT_THAT(problem("http://host:"), HasSubstr("1 to 65535"));
    EXPECT_THAT(problem("http://host:0"), HasSubstr("1 to 65535"));
    EXPECT_THAT(problem("http://host:65536"), HasSubstr("1 to 65535"));
    EXPECT_THAT(problem("http://host:70 70"), HasSubstr("1 to 65535"));
    EXPECT_THAT(problem("http://ho st"), HasSubstr("characters"));
    EXPECT_THAT(problem("http://host\r\nX: y"), HasSubstr("characters"));
    EXPECT_THAT(problem("http://[::1"), HasSubstr("']'"));
    EXPECT_THAT(problem("http://[::1]7070"), HasSubstr(":port"));
}

}  // namespace
}  // namespace tessera
