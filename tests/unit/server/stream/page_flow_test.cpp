#include "server/stream/page_flow.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

StreamAsk ask(std::uint32_t id, std::uint8_t urgency = 3) {
    StreamAsk made;
    made.id = id;
    made.key = {0, id, 0};
    made.urgency = {urgency};
    return made;
}

StreamPage page_of(std::uint32_t id, std::size_t bytes = 100) {
    auto page = std::make_shared<EncodedPage>();
    page->bytes = std::make_shared<const EncodedBytes>(bytes);
    StreamPage made;
    made.id = id;
    made.page = std::move(page);
    return made;
}

TEST(PageFlow, StartsNothingWithoutCreditsAndLittleBeyondThem) {
    const StreamOptions options;
    PageFlow flow{options};
    for (std::uint32_t id = 0; id < 100; ++id) ASSERT_EQ(flow.add(ask(id)), PageFlow::Added::yes);
    EXPECT_FALSE(flow.start());
    flow.grant(3);
    int started = 0;
    while (flow.start()) ++started;
    EXPECT_EQ(started, 5);
    flow.grant(1000);
    while (flow.start()) ++started;
    EXPECT_EQ(started, static_cast<int>(options.pages_under_way));
}

TEST(PageFlow, SendsAPageForACreditAndTheMostUrgentFirst) {
    const StreamOptions options;
    PageFlow flow{options};
    for (std::uint32_t id = 0; id < 4; ++id) flow.add(ask(id, static_cast<std::uint8_t>(7 - id)));
    flow.grant(2);
    std::vector<PageFlow::Started> started;
    while (const auto one = flow.start()) started.push_back(*one);
    ASSERT_EQ(started.size(), 4u);
    EXPECT_EQ(started[0].ask.id, 3u);
    for (const auto& one : started) flow.finish(one, page_of(one.ask.id));
    EXPECT_EQ(flow.take()->id, 3u);
    EXPECT_EQ(flow.take()->id, 2u);
    EXPECT_FALSE(flow.take());
    flow.grant(5);
    EXPECT_EQ(flow.take()->id, 1u);
    EXPECT_EQ(flow.take()->id, 0u);
    EXPECT_FALSE(flow.take());
    EXPECT_EQ(flow.waiting(), 0u);
    EXPECT_EQ(flow.held_bytes(), 0u);
}

TEST(PageFlow, KeepsNoMoreCreditsThanItsLimit) {
    StreamOptions options;
    options.credits = 10;
    PageFlow flow{options};
    for (int i = 0; i < 3; ++i) flow.grant(std::numeric_limits<std::uint64_t>::max());
    EXPECT_EQ(flow.credits(), 10u);
}

TEST(PageFlow, AnAskThatIsCancelledIsForgottenInEveryState) {
    const StreamOptions options;
    PageFlow flow{options};
    flow.grant(1);
    for (std::uint32_t id = 0; id < 5; ++id) flow.add(ask(id));
    const auto done = flow.start(), under_way = flow.start();
    ASSERT_TRUE(done && under_way);
    flow.finish(*done, page_of(0));
    for (const std::uint32_t id : {0u, 1u, 4u}) EXPECT_TRUE(flow.cancel(id));
    EXPECT_FALSE(flow.cancel(1));
    EXPECT_FALSE(flow.cancel(77));
    EXPECT_EQ(flow.held_bytes(), 0u);
    // The answer of one that was asked for again by the same number is not taken for its own
    flow.add(ask(1));
    flow.finish(*under_way, page_of(1));
    EXPECT_FALSE(flow.drop(*under_way));
    EXPECT_FALSE(flow.take());
    EXPECT_EQ(flow.waiting(), 3u);
}

TEST(PageFlow, HoldsFewBytesForASocketThatIsSlow) {
    StreamOptions options;
    options.held_bytes = 1000;
    PageFlow flow{options};
    flow.grant(100);
    for (std::uint32_t id = 0; id < 40; ++id) flow.add(ask(id));
    std::vector<PageFlow::Started> started;
    while (const auto one = flow.start()) started.push_back(*one);
    for (const auto& one : started) flow.finish(one, page_of(one.ask.id, 400));
    EXPECT_LE(flow.held_bytes(), 1000u);
    // All of them arrive all the same
    std::size_t sent = 0;
    while (const auto page = flow.take()) {
        ++sent;
        while (const auto one = flow.start()) flow.finish(*one, page_of(one->ask.id, 400));
        ASSERT_LE(flow.held_bytes(), 1000u);
    }
    EXPECT_EQ(sent, 40u);
    // and one that is larger than the limit alone, too
    flow.add(ask(1));
    flow.finish(*flow.start(), page_of(1, 5000));
    EXPECT_TRUE(flow.take());
}

TEST(PageFlow, RefusesASecondAskOfANumberAndTooMany) {
    StreamOptions options;
    options.asks = 3;
    PageFlow flow{options};
    EXPECT_EQ(flow.add(ask(1)), PageFlow::Added::yes);
    EXPECT_EQ(flow.add(ask(1)), PageFlow::Added::twice);
    EXPECT_EQ(flow.add(ask(2)), PageFlow::Added::yes);
    EXPECT_EQ(flow.add(ask(3)), PageFlow::Added::yes);
    EXPECT_EQ(flow.add(ask(4)), PageFlow::Added::too_many);
}

}  // namespace
}  // namespace tessera
