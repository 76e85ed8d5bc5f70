#include "server/prepare/parallel.h"

#include <new>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ForEachIndex, CallsTheWorkOnceForEachIndexOnAnyNumberOfThreads) {
    for (const std::size_t threads : {1U, 2U, 7U}) {
        std::vector<int> calls(100);
        for_each_index(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
        EXPECT_EQ(calls, std::vector<int>(100, 1));
    }
}

TEST(ForEachIndex, WhatOneCallThrowsOnAnyThreadIsThrownToTheCaller) {
    for (const std::size_t culprit : {0U, 1U, 63U}) {
        EXPECT_THROW(for_each_index(64, 4,
                                    [&](std::size_t i) {
                                        if (i == culprit) throw std::bad_alloc{};
                                    }),
                     std::bad_alloc);
    }
}

TEST(ForEachIndex, NothingIsBegunAfterACallHasThrown) {
    std::size_t calls = 0;
    EXPECT_THROW(for_each_index(1000, 1,
                                [&](std::size_t) {
                                    ++calls;
                                    throw std::runtime_error{"once"};
                                }),
                 std::runtime_error);
    EXPECT_EQ(calls, 1U);
}

}  // namespace
}  // namespace tessera
