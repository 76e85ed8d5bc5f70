#include "client/residency/page_requests.h"

#include <gmock/gmock.h>

#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera {
namespace {

using ::testing::ElementsAre;
using testing::FakePageSource;
using namespace std::chrono_literals;

PageKey page(std::uint32_t x) { return {0, x, 0}; }

TEST(PageRequests, AskForTheMostValuablePagesAndForNoMoreThanMayFly) {
    FakePageSource source{testing::blank_page};
    PageRequests requests{source, {.in_flight = 2}};
    requests.want({{page(1), 10}, {page(2), 30}, {page(3), 20}}, 0ms);
    EXPECT_THAT(source.asked, ElementsAre(page(2), page(3)));
    requests.want({{page(1), 10}, {page(2), 30}, {page(3), 20}}, 1ms);
    EXPECT_EQ(source.asked.size(), 2u);
    EXPECT_EQ(requests.take_arrived(8, 2ms).size(), 2u);
    requests.want({{page(1), 10}}, 3ms);
    EXPECT_EQ(source.asked.back(), page(1));
    EXPECT_EQ(source.duplicate_requests, 0);
}

TEST(PageRequests, AreCancelledOnceNobodyHasWantedThemForSomeFrames) {
    FakePageSource source{testing::blank_page};
    PageRequests requests{source, {.in_flight = 2, .frames_unwanted = 2}};
    requests.want({{page(1), 1}, {page(2), 1}}, 0ms);
    for (int frame = 0; frame < 2; ++frame) requests.want({{page(2), 1}}, 0ms);
    EXPECT_TRUE(source.cancelled().empty());
    requests.want({{page(2), 1}}, 0ms);
    EXPECT_THAT(source.cancelled(), ElementsAre(page(1)));
    const auto arrived = requests.take_arrived(8, 0ms);
    ASSERT_EQ(arrived.size(), 1u);
    EXPECT_EQ(arrived[0].page, page(2));
    EXPECT_EQ(requests.counts().cancelled, 1u);
    EXPECT_EQ(requests.in_flight(), 0u);
}

TEST(PageRequests, BackOffLongerAndLongerWhileTheServerFailsAndGoOnWhenItIsBack) {
    FakePageSource source{testing::blank_page};
    PageRequests requests{source, {.in_flight = 4}};
    source.failing = Error{ErrorCode::io_failure, "cannot connect"};
    std::vector<WantedPage> wanted;
    for (std::uint32_t x = 0; x < 100; ++x) wanted.push_back({page(x), 1});
    for (ClientTime now{0}; now < 60s; now += 10ms) {
        requests.want(wanted, now);
        requests.take_arrived(8, now);
    }
    EXPECT_LE(source.asked.size(), 20u) << "a minute of failures: a handful of tries";
    EXPECT_EQ(requests.problem(), "cannot connect");
    source.failing.reset();
    for (ClientTime now = 60s; now < 80s; now += 10ms) {
        requests.want(wanted, now);
        for (const ArrivedPage& arrived : requests.take_arrived(8, now))
            std::erase_if(wanted, [&](const WantedPage& want) { return want.page == arrived.page; });
    }
    EXPECT_TRUE(wanted.empty());
    EXPECT_EQ(requests.problem(), "");
}

TEST(PageRequests, NeverAskAgainForAPageThatDoesNotExist) {
    FakePageSource source{testing::blank_page};
    PageRequests requests{source, {}};
    source.failing = Error{ErrorCode::no_such_page, "404"};
    for (ClientTime now{0}; now < 60s; now += 100ms) {
        requests.want({{page(1), 1}}, now);
        requests.take_arrived(8, now);
    }
    EXPECT_EQ(source.asked.size(), 1u);
    EXPECT_TRUE(requests.is_given_up(page(1)));
}

/// Tells what it was asked, and answers what it is told to.
class ScriptedSource : public PageSource {
  public:
    bool request(const PageRequest& request) override {
        asked.push_back(request);
        return true;
    }
    void cancel(PageRequestId id) override { cancelled.push_back(id); }
    std::vector<ArrivedPage> take_arrived(std::size_t) override { return std::exchange(answers, {}); }
    void allow(std::size_t count) override { allowed = count; }

    std::vector<PageRequest> asked;
    std::vector<PageRequestId> cancelled;
    std::vector<ArrivedPage> answers;
    std::size_t allowed = 0;
};

TEST(PageRequests, SayWhichVersionIsWantedAndHowManyAnswersMayCome) {
    ScriptedSource source;
    PageRequests requests{source, {}};
    requests.want({{.page = page(1),
                    .gain = 1,
                    .least_revision = 7,
                    .step = 42,
                    .urgency = Urgency::renew,
                    .have = "tag"}},
                  0ms);
    ASSERT_EQ(source.asked.size(), 1u);
    EXPECT_EQ(source.asked[0].least_revision, 7u);
    EXPECT_EQ(source.asked[0].step, 42);
    EXPECT_EQ(source.asked[0].urgency, Urgency::renew);
    EXPECT_EQ(source.asked[0].have, "tag");
    EXPECT_EQ(source.allowed, requests.window().answers());
}

TEST(PageRequests, TakeUnchangedForAnAnswerAndDropWhatWasAnsweredBefore) {
    ScriptedSource source;
    PageRequests requests{source, {}};
    requests.want({{page(1), 1}}, 0ms);
    const ArrivedPage answer{
        .id = source.asked[0].id, .page = page(1), .texels = std::string{}, .unchanged = true};
    source.answers = {answer, answer};
    const auto arrived = requests.take_arrived(8, 50ms);
    ASSERT_EQ(arrived.size(), 1u);
    EXPECT_TRUE(arrived[0].unchanged);
    EXPECT_EQ(requests.counts().unchanged, 1u);
    EXPECT_EQ(requests.counts().unasked, 1u);
}

TEST(PageRequests, WaitAsLongAsTheServerSaysBeforeTheyAskAgain) {
    ScriptedSource source;
    PageRequests requests{source, {}};
    requests.want({{page(1), 1}}, 0ms);
    source.answers.push_back({.id = source.asked[0].id,
                              .page = page(1),
                              .texels = Error{ErrorCode::overloaded, "busy"},
                              .retry_ms = 3000});
    std::vector<PageKey> without;
    EXPECT_TRUE(requests.take_arrived(8, 10ms, &without).empty());
    EXPECT_THAT(without, ElementsAre(page(1)));
    requests.want({{page(1), 1}}, 2900ms);
    EXPECT_EQ(source.asked.size(), 1u);
    requests.want({{page(1), 1}}, 3100ms);
    EXPECT_EQ(source.asked.size(), 2u);
}

TEST(PageRequests, GiveUpARequestThatIsNeverAnswered) {
    ScriptedSource source;
    PageRequests requests{source, {.patience = 5000ms}};
    requests.want({{page(1), 1}}, 0ms);
    for (ClientTime now = 0ms; now < 8000ms; now += 100ms) requests.want({{page(1), 1}}, now);
    ASSERT_EQ(source.asked.size(), 2u);
    EXPECT_THAT(source.cancelled, ElementsAre(source.asked[0].id));
    EXPECT_EQ(requests.counts().failed, 1u);
}

TEST(PageRequests, RefuseAPageOfTheWrongSize) {
    FakePageSource source{[](PageKey) { return std::string(100, 'x'); }};
    PageRequests requests{source, {}};
    requests.want({{page(1), 1}}, 0ms);
    EXPECT_TRUE(requests.take_arrived(8, 0ms).empty());
    EXPECT_EQ(requests.counts().failed, 1u);
    EXPECT_THAT(requests.problem(), ::testing::HasSubstr("100 bytes"));
}

}  // namespace
}  // namespace tessera
