#include "server/access/token.h"

#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "server/access/access.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(Token, Holds256RandomBits) {
    std::set<std::string> seen;
    for (int i = 0; i < 100; ++i) {
        const std::string token = make_token();
        EXPECT_EQ(token.size(), 8 + 43u);  // 43 · 6 bits ≥ 256
        EXPECT_TRUE(seen.insert(token).second);
    }
}

TEST(Token, IsHashedBySha256) {
    // FIPS 180-2, appendix B.1
    EXPECT_THAT(token_line("editor", "ada", "abc", ""),
                "editor ada ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Token, LinesThatAreAddedAtATimeAreAllThere) {
    const tests::TemporaryFolder folder;
    const auto file = folder.path / "tokens";
    std::vector<std::string> tokens(8);
    {
        std::vector<std::jthread> people;
        for (std::string& token : tokens)
            people.emplace_back([&] {
                token = make_token();
                EXPECT_TRUE(add_token_line(file, token_line("editor", "ada", token, "2100-01-01")));
            });
    }
    struct stat status {};
    ASSERT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u);
    const Access access = Access::load(file).value();
    for (const std::string& token : tokens) EXPECT_TRUE(access.may_edit({false, token}).allowed);
}

TEST(Token, IsAddedBehindALineWithoutAnEnd) {
    const tests::TemporaryFolder folder;
    const auto file = folder.path / "tokens";
    const std::string ada = make_token(), bob = make_token();
    std::ofstream{file} << token_line("editor", "ada", ada, "");
    ASSERT_TRUE(add_token_line(file, token_line("editor", "bob", bob, "")));
    const Access access = Access::load(file).value();
    EXPECT_EQ(access.may_edit({false, ada}).name, "ada");
    EXPECT_EQ(access.may_edit({false, bob}).name, "bob");
}

TEST(Token, ABrokenFileStaysAsItIs) {
    const tests::TemporaryFolder folder;
    const auto file = folder.path / "tokens";
    std::ofstream{file} << "editor ada\n";
    EXPECT_THAT(add_token_line(file, token_line("editor", "bob", make_token(), "")).error().detail,
                HasSubstr("tokens:1: "));
    std::ostringstream text;
    text << std::ifstream{file}.rdbuf();
    EXPECT_EQ(text.str(), "editor ada\n");
}

TEST(Token, ADayIsWrittenInFull) {
    EXPECT_EQ(expiry_from("1970-01-02").value().time_since_epoch().count(), 86400);
    for (const char* wrong : {"", "2026-1-02", "2026-13-01", "2025-02-29", "2026/01/01", "2026-01-01x",
                              "-026-01-01", "1969-12-31"})
        EXPECT_FALSE(expiry_from(wrong)) << wrong;
}

}  // namespace
}  // namespace tessera
