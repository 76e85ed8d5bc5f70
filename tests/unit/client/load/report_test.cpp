#include "client/load/report.h"

#include <gmock/gmock.h>
#include <google/protobuf/struct.pb.h>
#include <gtest/gtest.h>

#include "client/load/progress_view.h"
#include "client/load/report_text.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

LoadOutcome outcome() {
    LoadOutcome result;
    LoadTally& t = result.tally;
    t.open_loop = true;
    t.measured = 10s;
    t.planned = 1000;
    t.sent = 999;
    t.ok = 990;
    t.refused = 9;
    t.unfinished = 1;
    t.body_bytes = 20'000'000;
    t.statuses = {{200, 990}, {404, 9}};
    t.pages_of_level[0] = 900;
    t.pages_of_level[7] = 99;
    t.corrected.record(2ms, 985);
    t.corrected.record(400ms, 6);
    t.uncorrected.record(1500us, 990);
    t.lateness.record(20us, 999);
    t.first_problem = "/scenes/\"x\"/0/0/0.png: status 404";
    result.client_cores = 0.25;
    return result;
}

LoadOptions options() {
    LoadOptions result;
    result.plan.server = {"127.0.0.1", 7070};
    result.plan.scene.id = "pebbles";
    result.plan.rate = 100;
    return result;
}

google::protobuf::Struct parsed(const std::string& text) {
    google::protobuf::Struct document;
    const auto read = read_json(text, "the report", document);
    EXPECT_TRUE(read) << read.error().detail << "\n" << text;
    return document;
}

std::vector<AssertionOutcome> checked(const LoadOutcome& result) {
    std::vector<AssertionOutcome> all;
    for (const char* text : {"p99<=5ms", "errors==0", "mismatches==0"})
        all.push_back(check(parse_assertion(text).value(), result.tally));
    return all;
}

TEST(LoadReport, IsJsonWithTheFieldsThatScriptsReadByName) {
    const LoadOutcome result = outcome();
    auto document = parsed(json_report(options(), result, checked(result)));
    auto& fields = *document.mutable_fields();
    EXPECT_EQ(fields["tessera_load"].number_value(), 1);
    EXPECT_EQ(fields["server"].string_value(), "http://127.0.0.1:7070");
    auto& requests = *fields["requests"].mutable_struct_value()->mutable_fields();
    EXPECT_EQ(requests["planned"].number_value(), 1000);
    EXPECT_EQ(requests["pages"].number_value(), 990);
    EXPECT_EQ(requests["errors"].number_value(), 10);
    EXPECT_EQ(fields["pages_per_s"].number_value(), 99);
    EXPECT_EQ(fields["bytes_per_s"].number_value(), 2e6);
    auto& latency = *fields["latency_ms"].mutable_struct_value()->mutable_fields();
    auto& corrected = *latency["corrected"].mutable_struct_value()->mutable_fields();
    EXPECT_NEAR(corrected["p99"].number_value(), 2, 0.01);
    EXPECT_NEAR(corrected["p99.9"].number_value(), 400, 2);
    EXPECT_EQ(corrected["max"].number_value(), 400);
    EXPECT_EQ((*latency["uncorrected"].mutable_struct_value()->mutable_fields())["count"].number_value(),
              990);
    EXPECT_EQ((*fields["statuses"].mutable_struct_value()->mutable_fields())["404"].number_value(), 9);
    EXPECT_EQ((*fields["levels"].mutable_struct_value()->mutable_fields())["7"].number_value(), 99);
    EXPECT_TRUE(fields["hit_rate"].has_null_value());
    EXPECT_TRUE(fields["verify"].has_null_value());
    EXPECT_EQ(fields["first_problem"].string_value(), result.tally.first_problem);
    const auto& assertions = fields["assertions"].list_value();
    ASSERT_EQ(assertions.values_size(), 3);
    EXPECT_TRUE(assertions.values(0).struct_value().fields().at("holds").bool_value());
    EXPECT_FALSE(assertions.values(1).struct_value().fields().at("holds").bool_value());
    EXPECT_TRUE(assertions.values(2).struct_value().fields().at("actual").has_null_value());
    const auto& buckets = fields["histograms_ns"].struct_value().fields().at("corrected").list_value();
    ASSERT_EQ(buckets.values_size(), 2);
    EXPECT_EQ(buckets.values(1).list_value().values(2).number_value(), 6);
}

TEST(LoadReport, IsJsonEvenIfNothingWasMeasured) {
    auto document = parsed(json_report(options(), LoadOutcome{}, {}));
    const auto& latency = document.fields().at("latency_ms").struct_value().fields();
    EXPECT_TRUE(latency.at("corrected").has_null_value());
    EXPECT_TRUE(document.fields().at("pages_per_s").has_null_value());
}

TEST(LoadReport, TellsPeopleTheSameAndWhichAssertionsFailed) {
    const LoadOutcome result = outcome();
    const std::string text = text_report(options(), result, checked(result));
    EXPECT_THAT(text, HasSubstr("990 of 1,000 planned"));
    EXPECT_THAT(text, HasSubstr("open loop at 100 pages/s"));
    EXPECT_THAT(text, HasSubstr("404: 9"));
    EXPECT_THAT(text, HasSubstr("holds   p99<=5ms"));
    EXPECT_THAT(text, HasSubstr("FAILED  errors==0"));
    EXPECT_THAT(text, HasSubstr("nothing measured"));
    EXPECT_THAT(text, HasSubstr("1 planned pages had no answer"));
}

TEST(LoadReport, WarnsWhenTheLoadGeneratorItselfWasLateOrAtItsLimit) {
    LoadOutcome result = outcome();
    result.tally.unfinished = 0;
    EXPECT_TRUE(warnings_of(result).empty());
    result.tally.lateness.record(5ms, 50);
    result.client_cores = 0.97;
    ASSERT_EQ(warnings_of(result).size(), 2u);
    EXPECT_THAT(warnings_of(result)[0], HasSubstr("itself was late"));
    EXPECT_THAT(warnings_of(result)[1], HasSubstr("0.97"));
    result.tally.open_loop = false;
    EXPECT_THAT(warnings_of(result).back(), HasSubstr("closed loop"));
}

TEST(LoadReport, WritesNumbersAsPeopleReadThem) {
    EXPECT_EQ(duration_text(812ns), "812 ns");
    EXPECT_EQ(duration_text(1240us), "1.24 ms");
    EXPECT_EQ(duration_text(999'600ns), "1.00 ms");
    EXPECT_EQ(duration_text(30'200ms), "30.2 s");
    EXPECT_EQ(bytes_text(21'840), "21.8 KB");
    EXPECT_EQ(count_text(1570312), "1,570,312");
    EXPECT_EQ(count_text(999), "999");
    EXPECT_EQ(count_text(1000), "1,000");
}

TEST(LoadReport, ShowsProgressWithAndWithoutATerminal) {
    const LoadOutcome result = outcome();
    LatencyHistogram recent;
    recent.record(3ms, 10);
    const LoadProgress progress{5s, 10s, false, false, 500ms, 100, 2'000'000, 1, recent, 4, 7, result.tally};
    EXPECT_EQ(progress_line(progress),
              "5.0 s of 10.0 s, measuring: 200 pages/s, 4.00 MB/s, p50 3.00 ms, p99 3.00 ms, 4 in flight, 7 "
              "behind the "
              "plan, 1 errors");
    const std::string block = progress_block(progress);
    EXPECT_EQ(std::count(block.begin(), block.end(), '\n'), 3);
    EXPECT_THAT(block, HasSubstr("990 pages"));
}

}  // namespace
}  // namespace tessera
