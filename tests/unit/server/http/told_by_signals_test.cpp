#include "server/http/told_by_signals.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ReloadRequest, MadeDuringALoadAsksForExactlyOneMore) {
    ReloadRequest request;
    std::stop_source stop;
    request.make();
    ASSERT_TRUE(request.wait(stop.get_token()));
    std::thread during_the_load{[&] {
        request.make();
        request.make();
    }};
    during_the_load.join();
    EXPECT_TRUE(request.wait(stop.get_token()));
    std::thread later{[&] { stop.request_stop(); }};
    EXPECT_FALSE(request.wait(stop.get_token())) << "two requests that nobody heard yet are one";
    later.join();
}

TEST(ReloadRequest, AStopComesFirst) {
    ReloadRequest request;
    std::stop_source stop;
    request.make();
    stop.request_stop();
    EXPECT_FALSE(request.wait(stop.get_token()));
}

}  // namespace
}  // namespace tessera
