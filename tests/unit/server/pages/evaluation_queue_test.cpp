#include "server/pages/evaluation_queue.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using Queue = EvaluationQueue<int>;

Queue::Place place(std::uint64_t number, std::uint8_t level, std::uint8_t urgency = 3) {
    return {.urgency = {urgency}, .level = level, .number = number};
}

void push(Queue& queue, std::uint64_t number, std::uint8_t level, std::uint8_t urgency = 3) {
    queue.push(place(number, level, urgency), std::make_shared<int>(static_cast<int>(number)));
}

TEST(EvaluationQueue, TakesTheUrgentThenTheCoarseThenTheOld) {
    Queue queue{10};
    push(queue, 1, 0);
    push(queue, 2, 0);
    push(queue, 3, 5);
    push(queue, 4, 9, 5);
    push(queue, 5, 0, 0);
    for (const int expected : {5, 3, 1, 2, 4}) EXPECT_EQ(*queue.take_most_urgent(), expected);
}

TEST(EvaluationQueue, AStreamOfCoarsePagesDoesNotHoldUpAFineOneForLong) {
    Queue queue{10000};
    push(queue, 1000, 0);
    std::uint64_t next = 1001;
    int waited = 0;
    // Two coarse pages come for each that is made
    for (;; ++waited) {
        push(queue, next++, 8);
        push(queue, next++, 8);
        if (*queue.take_most_urgent() == 1000) break;
        ASSERT_LT(waited, 1000) << "starved";
    }
    EXPECT_LE(waited, Queue::head_start * 8);
    EXPECT_GT(waited, 0);
}

TEST(EvaluationQueue, GivesUpTheLeastUrgent) {
    Queue queue{2};
    push(queue, 1, 0, 2);
    push(queue, 2, 7, 6);
    EXPECT_TRUE(queue.full());
    EXPECT_EQ(queue.least_urgent(), place(2, 7, 6));
    EXPECT_EQ(*queue.take_least_urgent(), 2);
    EXPECT_FALSE(queue.full());
}

}  // namespace
}  // namespace tessera
