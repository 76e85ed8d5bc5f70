#include "server/access/access.h"

#include <fstream>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "server/access/token.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class AccessTest : public testing::Test {
  protected:
    Result<Access> load(const std::string& text) {
        std::ofstream{file_} << text;
        return Access::load(file_);
    }
    std::string refusal(const std::string& text) {
        const auto access = load(text);
        return access ? "loaded" : access.error().detail;
    }

    const tests::TemporaryFolder folder_;
    const std::filesystem::path file_ = folder_.path / "tokens";
    const std::string token_ = make_token();
};

TEST_F(AccessTest, LoopbackEditsWithoutATokenInAnybodysName) {
    const Access nobody;
    const auto decision = nobody.may_edit({true, ""});
    EXPECT_TRUE(decision.allowed);
    EXPECT_EQ(decision.name, "");
    EXPECT_EQ(author_of("Ada", decision).value(), "Ada");
    EXPECT_EQ(author_of("", decision).value(), "");
}

TEST_F(AccessTest, ATokenThatIsSaidCountsOnThisMachineToo) {
    const std::string viewer = make_token();
    const Access access =
        load(token_line("editor", "ada", token_, "") + "\n" + token_line("viewer", "bob", viewer, ""))
            .value();
    EXPECT_TRUE(access.may_edit({true, token_}).allowed);
    EXPECT_TRUE(access.may_edit({true, ""}).allowed);
    for (const Access& asked : {access, Access{}}) {
        const auto wrong = asked.may_edit({true, make_token()});
        EXPECT_FALSE(wrong.allowed);
        EXPECT_FALSE(wrong.other_role);
        EXPECT_THAT(wrong.why, HasSubstr("leave it out"));
    }
    const auto bob = access.may_edit({true, viewer});
    EXPECT_FALSE(bob.allowed);
    EXPECT_TRUE(bob.other_role);
}

TEST_F(AccessTest, ElsewhereNeedsATokenOfTheRoleEditor) {
    const std::string viewer = make_token();
    const Access access = load("# who may edit\n\n" + token_line("editor", "ada", token_, "") + "\r\n" +
                               token_line("viewer", "bob", viewer, "") + "  # reads")
                              .value();
    const auto ada = access.may_edit({false, token_});
    EXPECT_TRUE(ada.allowed);
    EXPECT_EQ(ada.name, "ada");
    const auto bob = access.may_edit({false, viewer});
    EXPECT_FALSE(bob.allowed);
    EXPECT_TRUE(bob.other_role);
    EXPECT_THAT(bob.why, HasSubstr("viewer"));
    for (const std::string& wrong : {std::string{}, token_ + "x", token_.substr(1), make_token()}) {
        const auto nobody = access.may_edit({false, wrong});
        EXPECT_FALSE(nobody.allowed) << wrong;
        EXPECT_FALSE(nobody.other_role) << wrong;
        EXPECT_NE(nobody.why, "");
    }
}

TEST_F(AccessTest, AHashIsNoToken) {
    const std::string line = token_line("editor", "ada", token_, "");
    const Access access = load(line).value();
    EXPECT_FALSE(access.may_edit({false, line.substr(line.rfind(' ') + 1)}).allowed);
    EXPECT_FALSE(access.may_edit({false, hash_of_token(token_)}).allowed);
}

TEST_F(AccessTest, NothingIsNoTokenEvenWhereItsHashStandsInTheFile) {
    const Access access = load(token_line("editor", "nobody", "", "")).value();
    EXPECT_FALSE(access.may_edit({false, ""}).allowed);
}

TEST_F(AccessTest, FromElsewhereAnEditBearsTheNameOfItsToken) {
    const Access access = load(token_line("editor", "ada", token_, "")).value();
    const auto from_elsewhere = access.may_edit({false, token_});
    EXPECT_EQ(author_of("", from_elsewhere).value(), "ada");
    EXPECT_EQ(author_of("ada", from_elsewhere).value(), "ada");
    EXPECT_THAT(author_of("bob", from_elsewhere).error().detail, HasSubstr("author: "));
    const auto here = access.may_edit({true, token_});
    EXPECT_EQ(author_of("", here).value(), "ada");
    EXPECT_EQ(author_of("bob", here).value(), "bob");
}

TEST_F(AccessTest, ATokenIsGoodThroughItsLastDay) {
    const Access access = load(token_line("editor", "ada", token_, "2026-11-22")).value();
    const auto midnight = expiry_from("2026-11-23").value();
    EXPECT_TRUE(access.may_edit({false, token_}, midnight - std::chrono::seconds{1}).allowed);
    const auto late = access.may_edit({false, token_}, midnight);
    EXPECT_FALSE(late.allowed);
    EXPECT_FALSE(late.other_role);
    EXPECT_THAT(late.why, HasSubstr("expired"));
    const auto here = access.may_edit({true, token_}, midnight);
    EXPECT_FALSE(here.allowed);
    EXPECT_THAT(here.why, HasSubstr("expired"));
}

TEST_F(AccessTest, WhatIsWrongInAFileIsNamedWithItsLine) {
    const std::string good = token_line("editor", "ada", token_, "");
    EXPECT_THAT(refusal(good + "\neditor ada\n"), HasSubstr("tokens:2: "));
    EXPECT_THAT(refusal("owner" + good.substr(6)), HasSubstr("roles are editor and viewer"));
    EXPECT_THAT(refusal(good + "0"), HasSubstr("SHA-256"));
    EXPECT_THAT(refusal(good.substr(0, good.size() - 1)), HasSubstr("SHA-256"));
    EXPECT_THAT(refusal(good.substr(0, good.size() - 1) + "g"), HasSubstr("SHA-256"));
    EXPECT_THAT(refusal(good + " 2026-02-30"), HasSubstr("2026-02-30"));
    EXPECT_THAT(refusal(good + " 2026-12-30 more"), HasSubstr("a line is"));
    EXPECT_THAT(refusal(good + "\n" + good), HasSubstr("tokens:2: the hash stands"));
    EXPECT_THAT(refusal("editor \x1b[2J " + good.substr(11)), HasSubstr("letters, digits"));
    EXPECT_EQ(refusal(""), "loaded");
}

TEST_F(AccessTest, AFileThatOthersMayWriteIsRefused) {
    std::ofstream{file_} << token_line("editor", "ada", token_, "");
    ASSERT_EQ(::chmod(file_.c_str(), 0620), 0);
    EXPECT_THAT(Access::load(file_).error().detail, HasSubstr("chmod 600"));
    EXPECT_EQ(Access::load(folder_.path).error().code, ErrorCode::io_failure);
    EXPECT_EQ(Access::load(folder_.path / "none").error().code, ErrorCode::io_failure);
}

}  // namespace
}  // namespace tessera
