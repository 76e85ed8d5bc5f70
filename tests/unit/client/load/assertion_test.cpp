#include "client/load/assertion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

LoadTally tally() {
    LoadTally t;
    t.open_loop = true;
    t.measured = 2s;
    t.planned = 200;
    t.ok = 190;
    t.shed = 6;
    t.refused = 4;
    t.body_bytes = 1000;
    t.statuses = {{200, 190}, {503, 6}, {404, 4}};
    t.cache_results = {{"hit", 30}, {"miss", 10}};
    t.corrected.record(4ms, 99);
    t.corrected.record(80ms, 1);
    t.uncorrected.record(1ms, 100);
    return t;
}

bool holds(std::string_view text) {
    const auto assertion = parse_assertion(text);
    EXPECT_TRUE(assertion) << assertion.error().detail;
    return check(*assertion, tally()).holds;
}

TEST(Assertion, ComparesMeasuresInTheirUnits) {
    EXPECT_TRUE(holds("p99<=5ms"));
    EXPECT_TRUE(holds("p99 <= 5"));
    EXPECT_TRUE(holds("p99<5000us"));
    EXPECT_FALSE(holds("p99.9<=0.05s"));
    EXPECT_TRUE(holds("max>=80ms"));
    EXPECT_TRUE(holds("uncorrected.p99.9<2ms"));
    EXPECT_TRUE(holds("mean > 4 ms"));
    EXPECT_TRUE(holds("errors==10"));
    EXPECT_FALSE(holds("errors==0"));
    EXPECT_TRUE(holds("errors!=0"));
    EXPECT_TRUE(holds("error_rate<=5%"));
    EXPECT_FALSE(holds("error_rate<0.05"));
    EXPECT_TRUE(holds("shed=6"));
    EXPECT_TRUE(holds("status.404==4"));
    EXPECT_TRUE(holds("status.500==0"));
    EXPECT_TRUE(holds("pages_per_s>=95"));
    EXPECT_TRUE(holds("bytes_per_s==500"));
    EXPECT_TRUE(holds("hit_rate==75%"));
}

TEST(Assertion, TakesRatesOverTheTimeThatThePagesReallyTook) {
    LoadTally late = tally();
    late.until_last_page = 4s;
    EXPECT_EQ(check(*parse_assertion("bytes_per_s==250"), late).actual, 250);
    late.until_last_page = 1s;
    EXPECT_EQ(check(*parse_assertion("bytes_per_s==500"), late).actual, 500);
}

TEST(Assertion, FailsWhereNothingWasMeasured) {
    EXPECT_FALSE(holds("late.p99<=1s"));
    EXPECT_FALSE(holds("mismatches==0"));
    EXPECT_FALSE(check(*parse_assertion("p99<=5ms"), LoadTally{}).holds);
    EXPECT_EQ(check(*parse_assertion("error_rate<=1"), LoadTally{}).actual, std::nullopt);
}

TEST(Assertion, SaysWhatIsWrongWithItsText) {
    const auto problem = [](std::string_view text) {
        const auto parsed = parse_assertion(text);
        EXPECT_FALSE(parsed) << text;
        return parsed ? std::string{} : parsed.error().detail;
    };
    EXPECT_THAT(problem("p99"), HasSubstr("METRIC<=LIMIT"));
    EXPECT_THAT(problem(""), HasSubstr("METRIC<=LIMIT"));
    EXPECT_THAT(problem("speed<=5"), HasSubstr("pages_per_s"));
    EXPECT_THAT(problem("p101<=5"), HasSubstr("not measured"));
    EXPECT_THAT(problem("pnan<=5"), HasSubstr("not measured"));
    EXPECT_THAT(problem("p99<=>5"), HasSubstr("none of"));
    EXPECT_THAT(problem("p99<="), HasSubstr("a number is missing"));
    EXPECT_THAT(problem("p99<=inf"), HasSubstr("a number is missing"));
    EXPECT_THAT(problem("p99<=5MB"), HasSubstr("unit 'MB'"));
    EXPECT_THAT(problem("errors<=5ms"), HasSubstr("does not fit errors"));
    EXPECT_THAT(problem("errors<=5%"), HasSubstr("does not fit errors"));
    EXPECT_THAT(problem("status.9<=5"), HasSubstr("not measured"));
}

}  // namespace
}  // namespace tessera
