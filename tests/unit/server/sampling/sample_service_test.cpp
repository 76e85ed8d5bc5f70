#include "server/sampling/sample_service.h"

#include <future>

#include <gtest/gtest.h>

#include "proto/sample.pb.h"

#include "tests/unit/server/sampling/made_filters.h"

namespace tessera {
namespace {

using test::eventually;
using test::MadeFilters;
using test::scene_to_sample;

struct Asked {
    SampleService::Ticket ticket;
    std::future<Result<SampleReply>> result;
};

Asked ask(SampleService& service, SampleCall call) {
    const auto promise = std::make_shared<std::promise<Result<SampleReply>>>();
    Asked asked;
    asked.result = promise->get_future();
    asked.ticket = service.request(
        std::move(call), [promise](Result<SampleReply> reply) { promise->set_value(std::move(reply)); });
    return asked;
}

proto::SampleAnswer answer_in(const Result<SampleReply>& reply) {
    proto::SampleAnswer answer;
    EXPECT_TRUE(reply) << reply.error().detail;
    if (reply) {
        EXPECT_TRUE(answer.ParseFromString(reply->body));
    }
    answer.clear_milliseconds();
    return answer;
}

class SampleServiceTest : public testing::Test {
  protected:
    SampleCall call(int footprints, const std::string& filter = "exact", int first = 0) const {
        proto::SampleRequest request;
        request.set_filter(filter);
        for (int i = first; i < first + footprints; ++i) {
            request.add_footprints()->set_origin_x(i);
            request.mutable_footprints(i - first)->mutable_axes()->set_x(i * 0.5);
        }
        return {scene, request.SerializeAsString(), WireCoding::protobuf, WireCoding::protobuf};
    }

    MadeFilters made;
    ScenePtr scene = scene_to_sample();
    prometheus::Registry registry;
};

TEST_F(SampleServiceTest, GivesTheSameBytesFromOneThreadFromManyAndFootprintByFootprint) {
    prometheus::Registry other;
    SampleService one{{.threads = 1}, registry, made.makers()}, many{{.threads = 6}, other, made.makers()};
    const proto::SampleAnswer serial = answer_in(ask(one, call(3000, "")).result.get());
    const proto::SampleAnswer parallel = answer_in(ask(many, call(3000, "")).result.get());
    ASSERT_EQ(serial.texels_size(), 3000);
    EXPECT_EQ(serial.SerializeAsString(), parallel.SerializeAsString());
    for (const int i : {0, 255, 256, 2999}) {
        const proto::SampleAnswer single = answer_in(ask(one, call(1, "", i)).result.get());
        for (int c = 0; c < 4; ++c) EXPECT_EQ(single.colors(c), serial.colors(4 * i + c));
        EXPECT_EQ(single.bound_codes(0), serial.bound_codes(i));
    }
}

TEST_F(SampleServiceTest, DealsALargeRequestToItsThreads) {
    SampleService service{{.threads = 3}, registry, made.makers()};
    made.open = false;
    Asked large = ask(service, call(4000));
    EXPECT_TRUE(eventually([&] { return made.at_a_time == 3; }));
    made.open = true;
    EXPECT_EQ(answer_in(large.result.get()).texels_size(), 4000);
    EXPECT_EQ(made.most_at_a_time, 3);
    EXPECT_EQ(service.metrics().samples(FilterKind::exact), 4000);
}

TEST_F(SampleServiceTest, DoesNotLetALargeRequestHoldUpASmallOne) {
    SampleService service{{.threads = 1}, registry, made.makers()};
    made.open = false;
    Asked large = ask(service, call(60'000));
    ASSERT_TRUE(eventually([&] { return made.begun == 1; }));
    // Counted on the one thread that samples, when it answers: nothing begins meanwhile
    std::promise<int> parts_before_small;
    const SampleService::Ticket small = service.request(call(10), [&](const Result<SampleReply>& reply) {
        EXPECT_TRUE(reply);
        parts_before_small.set_value(made.begun.load());
    });
    made.open = true;
    EXPECT_LT(parts_before_small.get_future().get(), 10);  // of 236
    EXPECT_TRUE(large.result.get());
}

TEST_F(SampleServiceTest, TakesTheCheapestFilterThatMeetsTheBudget) {
    SampleService service{{.threads = 2}, registry, made.makers()};
    const auto within = [&](double max_error) {
        SampleCall budget = call(2, "");
        proto::SampleRequest request;
        request.ParseFromString(budget.body);
        request.set_max_error(max_error);
        budget.body = request.SerializeAsString();
        return answer_in(ask(service, budget).result.get());
    };
    EXPECT_EQ(within(10).bound_codes(0), 8);
    EXPECT_NE(within(10).filters(0), "exact");
    EXPECT_EQ(within(1).bound_codes(0), 0.125F);
    EXPECT_EQ(within(1).filters(0), "exact");
    EXPECT_EQ(within(0).bound_codes(0), 0.125F);  // as near as it gets
}

TEST_F(SampleServiceTest, SamplesTheSliceThatLooksLikeTheOneAskedFor) {
    auto sliced = std::make_shared<Scene>(*scene);
    sliced->slices = 8;
    scene = sliced;
    SampleService service{{.threads = 1}, registry, made.makers()};
    SampleCall asked = call(1);
    proto::SampleRequest request;
    request.ParseFromString(asked.body);
    request.set_slice(-1);
    asked.body = request.SerializeAsString();
    EXPECT_EQ(answer_in(ask(service, asked).result.get()).colors(2), 7);
}

TEST_F(SampleServiceTest, SaysWhatIsWrongWithARequest) {
    SampleService service{{.threads = 1}, registry, made.makers()};
    SampleCall broken = call(1);
    broken.body = "no message";
    EXPECT_EQ(ask(service, broken).result.get().error().code, ErrorCode::malformed_request);
    SampleCall channels = call(1);
    channels.coding = WireCoding::json;
    channels.body = R"({"channels": "height", "footprints": [{"axes": {}}]})";
    const auto missing = ask(service, channels).result.get();
    EXPECT_EQ(missing.error().code, ErrorCode::no_such_page);
    EXPECT_NE(missing.error().detail.find("albedo"), std::string::npos);
    EXPECT_EQ(service.metrics().requests(SampleResult::malformed), 2);
    EXPECT_EQ(made.begun, 0);
}

TEST_F(SampleServiceTest, RefusesWhatIsTooMuchAndGoesOn) {
    SampleService service{{.threads = 1, .waiting_requests = 2}, registry, made.makers()};
    made.open = false;
    Asked first = ask(service, call(1)), second = ask(service, call(1));
    EXPECT_EQ(ask(service, call(1)).result.get().error().code, ErrorCode::overloaded);
    made.open = true;
    EXPECT_TRUE(first.result.get());
    EXPECT_TRUE(second.result.get());
    EXPECT_TRUE(ask(service, call(1)).result.get());
    EXPECT_EQ(service.metrics().requests(SampleResult::overloaded), 1);
    EXPECT_EQ(service.metrics().requests(SampleResult::answered), 3);
}

TEST_F(SampleServiceTest, StopsWhenTheAskerLeaves) {
    SampleService service{{.threads = 1, .waiting_requests = 3}, registry, made.makers()};
    made.open = false;
    {
        const Asked running = ask(service, call(60'000));
        ASSERT_TRUE(eventually([&] { return made.at_a_time == 1; }));
        const Asked waiting = ask(service, call(10));
    }
    EXPECT_TRUE(eventually([&] { return made.at_a_time == 0; }));
    EXPECT_EQ(service.metrics().requests(SampleResult::cancelled), 2);
    made.open = true;
    EXPECT_TRUE(ask(service, call(1)).result.get());
    EXPECT_LE(made.begun, 3);  // the rest of the large one was never begun
}

TEST_F(SampleServiceTest, EndsAtTheDeadline) {
    SampleService service{{.threads = 1, .deadline = std::chrono::milliseconds{30}}, registry, made.makers()};
    made.open = false;
    Asked late = ask(service, call(1)), queued = ask(service, call(1));
    EXPECT_EQ(late.result.get().error().code, ErrorCode::timed_out);
    EXPECT_EQ(queued.result.get().error().code, ErrorCode::timed_out);
    made.open = true;
    EXPECT_EQ(service.metrics().requests(SampleResult::timed_out), 2);
}

TEST_F(SampleServiceTest, AFailureIsTheAskersAlone) {
    SampleService service{{.threads = 2}, registry, made.makers()};
    made.errors_left = 1;
    EXPECT_EQ(ask(service, call(5000)).result.get().error().code, ErrorCode::io_failure);
    EXPECT_TRUE(ask(service, call(5000)).result.get());
}

TEST_F(SampleServiceTest, TellsWhoeverWaitsThatItStops) {
    SampleService service{{.threads = 1}, registry, made.makers()};
    made.open = false;
    Asked running = ask(service, call(1000)), waiting = ask(service, call(1));
    service.stop();
    EXPECT_EQ(running.result.get().error().code, ErrorCode::cancelled);
    EXPECT_EQ(waiting.result.get().error().code, ErrorCode::cancelled);
    EXPECT_FALSE(ask(service, call(1)).result.get());
}

TEST_F(SampleServiceTest, SurvivesAskersThatComeAndGoOnManyThreads) {
    SampleService service{{.threads = 3, .waiting_requests = 8}, registry, made.makers()};
    std::vector<std::thread> askers;
    std::atomic<int> answers = 0;
    for (int t = 0; t < 4; ++t)
        askers.emplace_back([&, t] {
            for (int i = 0; i < 100; ++i) {
                Asked asked = ask(service, call(1 + (i * 37 + t) % 900));
                if ((i + t) % 3 == 0) continue;  // leaves
                if (const auto reply = asked.result.get()) {
                    ++answers;
                } else {
                    EXPECT_EQ(reply.error().code, ErrorCode::overloaded);
                }
            }
        });
    for (std::thread& asker : askers) asker.join();
    EXPECT_GT(answers, 0);
    EXPECT_TRUE(eventually([&] {
        service.update_gauges();
        return service.metrics().waiting.Value() == 0;
    }));
    EXPECT_TRUE(ask(service, call(10)).result.get());
}

}  // namespace
}  // namespace tessera
