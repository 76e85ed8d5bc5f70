#include "server/http/answer.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(IfNoneMatch, IsAListComparedWeakly) {
    EXPECT_TRUE(matches("\"a\"", "\"a\""));
    EXPECT_TRUE(matches("W/\"a\"", "\"a\""));
    EXPECT_TRUE(matches("\"x\" ,\t\"a\"", "\"a\""));
    EXPECT_TRUE(matches(" * ", "\"a\""));
    EXPECT_FALSE(matches("", "\"a\""));
    EXPECT_FALSE(matches("\"ab\"", "\"a\""));
    EXPECT_FALSE(matches("a", "\"a\""));
}

TEST(AcceptEncoding, AllowsACodingByNameUnlessItsWeightIsZero) {
    EXPECT_TRUE(accepts("zstd", "zstd"));
    EXPECT_TRUE(accepts("gzip, br, ZSTD", "zstd"));
    EXPECT_TRUE(accepts("zstd ; q=0.001", "zstd"));
    EXPECT_FALSE(accepts("", "zstd"));
    EXPECT_FALSE(accepts("*", "zstd"));
    EXPECT_FALSE(accepts("zstd;q=0", "zstd"));
    EXPECT_FALSE(accepts("zstd;q=0.000", "zstd"));
    EXPECT_FALSE(accepts("xzstd, zstdx", "zstd"));
}

TEST(Priority, IsTheUrgencyAndThreeUnlessItSaysOtherwise) {
    EXPECT_EQ(urgency_of("u=0").value, 0);
    EXPECT_EQ(urgency_of("i, u=7").value, 7);
    for (const char* odd : {"", "i", "u=8", "u=-1", "u=10", "U=1", "u"})
        EXPECT_EQ(urgency_of(odd).value, 3) << odd;
}

TEST(PagePrelude, TellsABoundThatIsAllButCertainFromOneThatIs) {
    EncodedPage page;
    page.bytes = std::make_shared<const EncodedBytes>();
    EXPECT_NE(page_prelude(page).find("\r\nTessera-Confidence: 1\r\n"), std::string::npos);
    page.evaluation.confidence = 1 - 1e-9;
    EXPECT_NE(page_prelude(page).find("\r\nTessera-Confidence: 0.999999999\r\n"), std::string::npos);
}

TEST(ErrorAnswer, TellsPassingFromLastingAndKeepsTheInsideInside) {
    const Answer busy = error_answer({ErrorCode::overloaded, "too many"});
    EXPECT_EQ(busy.status, 503u);
    EXPECT_NE(busy.fields.find("Retry-After: 1\r\n"), std::string::npos);
    EXPECT_NE(busy.fields.find("Refresh: 1\r\n"), std::string::npos) << "a browser would stay with it";
    const Answer broken = error_answer({ErrorCode::io_failure, "/home/someone/secret.png: cannot be read"});
    EXPECT_EQ(broken.status, 500u);
    const std::string body(broken.body.begin(), broken.body.end());
    EXPECT_EQ(body.find("secret"), std::string::npos);
    for (const Answer* answer : {&busy, &broken})
        EXPECT_NE(answer->fields.find("Cache-Control: no-store\r\n"), std::string::npos);
}

}  // namespace
}  // namespace tessera
