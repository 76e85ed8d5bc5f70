// Samples over a real socket: what a renderer sees.
#include <cmath>

#include <gtest/gtest.h>

#include "proto/sample.pb.h"

#include "shared/math/srgb.h"
#include "shared/wire/json.h"
#include "tests/end_to_end/server/running_server.h"

namespace tessera {
namespace {

using test::RawClient;
using test::Reply;
using test::RunningServer;

const std::string protobuf_type = "Content-Type: application/x-protobuf\r\n",
                  json_type = "Content-Type: application/json\r\n";

std::string post(const std::string& scene, const std::string& fields, const std::string& body) {
    return "POST /scenes/" + scene +
           "/sample HTTP/1.1\r\nHost: test\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" +
           fields + "\r\n" + body;
}

Reply sample(RawClient& client, const std::string& scene, const std::string& fields,
             const std::string& body) {
    EXPECT_TRUE(client.send(post(scene, fields, body)));
    return client.receive().value();
}

/// One square footprint of `side` texels, `count` times along x.
proto::SampleRequest squares(int count, double side, const std::string& filter = "exact") {
    proto::SampleRequest request;
    request.set_filter(filter);
    for (int i = 0; i < count; ++i) {
        proto::SampleFootprint& footprint = *request.add_footprints();
        footprint.set_origin_x(37 * i);
        footprint.mutable_axes()->set_x(side / 2);
        footprint.mutable_axes()->set_y(side / 2);
        footprint.mutable_axes()->set_along_x(side);
        footprint.mutable_axes()->set_across_y(side);
    }
    return request;
}

proto::SampleAnswer answer_in(const Reply& reply) {
    EXPECT_EQ(reply.status, 200) << reply.body;
    proto::SampleAnswer answer;
    if (reply["content-type"] == "application/json") {
        EXPECT_TRUE(read_json(reply.body, "answer", answer));
    } else {
        EXPECT_EQ(reply["content-type"], "application/x-protobuf");
        EXPECT_TRUE(answer.ParseFromString(reply.body));
    }
    answer.clear_milliseconds();
    return answer;
}

double linear_of(int code) {
    return code <= 10 ? code / 255.0 / 12.92 : std::pow((code / 255.0 + 0.055) / 1.055, 2.4);
}

TEST(Sampling, AnswersInTheCodingOfTheRequestUnlessAnotherIsAccepted) {
    RunningServer running;
    RawClient client = running.client();
    const proto::SampleRequest request = squares(5, 3);
    const Reply binary = sample(client, "board", protobuf_type, request.SerializeAsString());
    const Reply text = sample(client, "board", json_type, write_brief_json(request));
    const Reply crossed =
        sample(client, "board", json_type + "Accept: application/x-protobuf\r\n", write_brief_json(request));
    EXPECT_EQ(binary["content-type"], "application/x-protobuf");
    EXPECT_EQ(text["content-type"], "application/json");
    EXPECT_EQ(crossed["content-type"], "application/x-protobuf");
    EXPECT_EQ(answer_in(binary).SerializeAsString(), answer_in(text).SerializeAsString());
    EXPECT_EQ(answer_in(binary).SerializeAsString(), answer_in(crossed).SerializeAsString());
    for (const Reply& reply : {binary, text}) {
        EXPECT_EQ(reply["cache-control"], "no-store");
        EXPECT_EQ(reply["etag"], "");
        EXPECT_EQ(reply["access-control-allow-origin"], "*");
        EXPECT_NE(reply["server-timing"].find("sample;dur="), std::string::npos);
    }
}

TEST(Sampling, AveragesWhatThePagesShow) {
    RunningServer running;
    RawClient client = running.client();
    // Cells of 37 texels: footprint i begins at cell i, 37 texels to the right of the one before
    const proto::SampleAnswer cells =
        answer_in(sample(client, "board", protobuf_type, squares(4, 37).SerializeAsString()));
    const float red = static_cast<float>(linear_of(220)), green = static_cast<float>(linear_of(40));
    for (int i = 0; i < 4; ++i) {
        const float* color = cells.colors().data() + 4 * i;
        const float alpha = i % 2 == 0 ? 1 : 128.0F / 255;
        EXPECT_NEAR(color[0], i % 2 == 0 ? red : alpha, 1e-4F) << i;
        EXPECT_NEAR(color[1], i % 2 == 0 ? green : alpha, 1e-4F) << i;
        EXPECT_NEAR(color[3], alpha, 1e-4F) << i;
        EXPECT_LT(cells.bound_codes(i), 0.05) << i;
        EXPECT_EQ(cells.confidence(i), 1) << i;
        EXPECT_GT(cells.texels(i), 0u) << i;
    }
    // Two by two cells are half of each
    const proto::SampleAnswer mean =
        answer_in(sample(client, "board", protobuf_type, squares(1, 74).SerializeAsString()));
    EXPECT_NEAR(mean.colors(0), (red + 128.0F / 255) / 2, 1e-4F);
    EXPECT_EQ(mean.filters(0), "exact");
}

TEST(Sampling, ABatchGivesTheBytesOfItsFootprintsOnAnyNumberOfThreads) {
    ServerOptions one = test::quick_options(), four = test::quick_options();
    one.samples.threads = 1;
    four.samples.threads = 4;
    one.samples.deadline = four.samples.deadline = std::chrono::minutes{1};  // under sanitizers too
    RunningServer a{one}, b{four};
    RawClient from_a = a.client(), from_b = b.client();
    for (const std::string filter : {"", "exact", "trilinear"}) {
        proto::SampleRequest request = squares(700, 21.5, filter);
        for (int i = 0; i < request.footprints_size(); ++i) {
            request.mutable_footprints(i)->set_origin_x(i % 90 * 7);
            request.mutable_footprints(i)->mutable_axes()->set_across_x((i % 50) * 0.3);
        }
        const std::string body = request.SerializeAsString();
        const proto::SampleAnswer serial = answer_in(sample(from_a, "board", protobuf_type, body));
        EXPECT_EQ(serial.SerializeAsString(),
                  answer_in(sample(from_b, "board", protobuf_type, body)).SerializeAsString());
        for (const int i : {0, 300, 699}) {
            proto::SampleRequest single = request;
            single.mutable_footprints()->Clear();
            *single.add_footprints() = request.footprints(i);
            const proto::SampleAnswer alone =
                answer_in(sample(from_b, "board", protobuf_type, single.SerializeAsString()));
            for (int c = 0; c < 4; ++c) EXPECT_EQ(alone.colors(c), serial.colors(4 * i + c)) << filter << i;
            EXPECT_EQ(alone.bound_codes(0), serial.bound_codes(i)) << filter << i;
            EXPECT_EQ(alone.filters(static_cast<int>(alone.filter(0))),
                      serial.filters(static_cast<int>(serial.filter(i))));
        }
    }
}

TEST(Sampling, RefusesWithAReason) {
    RunningServer running;
    const std::string good = squares(1, 2).SerializeAsString();
    const auto status = [&](const std::string& scene, const std::string& fields, const std::string& body) {
        RawClient client = running.client();
        const Reply reply = sample(client, scene, fields, body);
        EXPECT_EQ(reply["cache-control"], "no-store");
        EXPECT_GT(reply.body.size(), 10u);
        return reply.status;
    };
    EXPECT_EQ(status("nothing", protobuf_type, good), 404);
    EXPECT_EQ(status("board", "", good), 415);
    EXPECT_EQ(status("board", "Content-Type: text/plain\r\n", good), 415);
    EXPECT_EQ(status("board", protobuf_type + "Content-Encoding: gzip\r\n", good), 415);
    EXPECT_EQ(status("board", protobuf_type + "Accept: image/png\r\n", good), 406);
    EXPECT_EQ(status("board", protobuf_type, ""), 400);
    EXPECT_EQ(status("board", protobuf_type, "nonsense"), 400);
    EXPECT_EQ(status("board", json_type, "{\"footprints\": [{}]}"), 400);
    EXPECT_EQ(status("board", json_type, "{\"channels\": \"height\", \"footprints\": [{\"axes\": {}}]}"),
              404);
    EXPECT_EQ(status("board?step=1", protobuf_type, good), 405);  // no such place to post to

    RawClient client = running.client();
    const Reply wrong =
        sample(client, "board", json_type,
               R"({"footprints": [{"axes": {}}, {"axes": {}}, {"axes": {"along_x": "NaN"}}]})");
    EXPECT_EQ(wrong.status, 400);
    EXPECT_EQ(wrong.body, "footprints[2].axes.along_x: is not a finite number\n");
    EXPECT_EQ(sample(client, "board", protobuf_type, good).status, 200);  // the connection goes on

    const Reply get = client.get("/scenes/board/sample").value();
    EXPECT_EQ(get.status, 405);
    EXPECT_EQ(get["allow"], "POST, OPTIONS");
    const Reply options = client.get("/scenes/board/sample", "Origin: http://a\r\n", "OPTIONS").value();
    EXPECT_EQ(options.status, 204);
    EXPECT_EQ(options["access-control-allow-methods"], "POST, OPTIONS");
    EXPECT_NE(options["access-control-allow-headers"].find("Content-Type"), std::string::npos);
}

TEST(Sampling, BodiesHaveALimitEachAndTogether) {
    ServerOptions options = test::quick_options();
    options.session.body_bytes = 100'000;
    options.bodies_bytes = 150'000;
    RunningServer running{options};
    {
        RawClient client = running.client();
        ASSERT_TRUE(
            client.send("POST /scenes/board/sample HTTP/1.1\r\nHost: t\r\nContent-Length: 100001\r\n" +
                        protobuf_type + "\r\n"));
        EXPECT_EQ(client.receive().value().status, 413);
        EXPECT_TRUE(client.is_closed());
    }
    const auto asked_to_send = [&](RawClient& client) {
        client.send(
            "POST /scenes/board/sample HTTP/1.1\r\nHost: t\r\nContent-Length: 99999\r\nExpect: "
            "100-continue\r\n" +
            protobuf_type + "\r\n");
        return client.receive().value();
    };
    RawClient first = running.client(), second = running.client(), third = running.client();
    EXPECT_EQ(asked_to_send(first).status, 100);
    EXPECT_EQ(asked_to_send(second).status, 100);  // each has room for a first part
    const Reply refused = asked_to_send(third);
    EXPECT_EQ(refused.status, 503);
    EXPECT_EQ(refused["retry-after"], "1");
    // One of them goes on, and there is no room for its end beside the other
    EXPECT_TRUE(first.send(std::string(99'999, 'x')));
    EXPECT_EQ(first.receive().value().status, 503);
    EXPECT_TRUE(test::eventually([&] {
        RawClient again = running.client();
        return sample(again, "board", protobuf_type, squares(1500, 2).SerializeAsString()).status == 200;
    }));
}

TEST(Sampling, WaitsForBodiesOnlySoLong) {
    ServerOptions options = test::quick_options();
    options.session.body_time = std::chrono::milliseconds{200};
    RunningServer running{options};
    RawClient slow = running.client();
    ASSERT_TRUE(slow.send("POST /scenes/board/sample HTTP/1.1\r\nHost: t\r\nContent-Length: 500\r\n" +
                          protobuf_type + "\r\nabc"));
    EXPECT_EQ(slow.receive().value().status, 408);
    EXPECT_TRUE(slow.is_closed());
    RawClient half = running.client();
    ASSERT_TRUE(half.send("POST /scenes/board/sample HTTP/1.1\r\nHost: t\r\nContent-Length: 500\r\n" +
                          protobuf_type + "\r\nabc"));
    half.close_sending();
    EXPECT_FALSE(half.receive());
}

TEST(Sampling, SaysGoOnToClientsThatAsk) {
    RunningServer running;
    RawClient client = running.client();
    const std::string body = squares(2, 2).SerializeAsString();
    ASSERT_TRUE(client.send(
        "POST /scenes/board/sample HTTP/1.1\r\nHost: t\r\nExpect: 100-continue\r\nContent-Length: " +
        std::to_string(body.size()) + "\r\n" + protobuf_type + "\r\n"));
    EXPECT_EQ(client.receive().value().status, 100);
    ASSERT_TRUE(client.send(body));
    EXPECT_EQ(client.receive().value().status, 200);
    ASSERT_TRUE(client.send(
        "POST /scenes/none/sample HTTP/1.1\r\nHost: t\r\nExpect: 100-continue\r\nContent-Length: " +
        std::to_string(body.size()) + "\r\n" + protobuf_type + "\r\n"));
    EXPECT_EQ(client.receive().value().status, 404);  // before anything was sent in vain
    EXPECT_TRUE(client.is_closed());
}

TEST(Sampling, TakesRequestsOneBehindTheOther) {
    RunningServer running;
    RawClient client = running.client();
    const std::string one = post("board", protobuf_type, squares(3, 2).SerializeAsString());
    ASSERT_TRUE(client.send(one + "GET /healthz HTTP/1.1\r\nHost: t\r\n\r\n" + one));
    EXPECT_EQ(client.receive().value().status, 200);
    EXPECT_EQ(client.receive().value().body, "alive\n");
    EXPECT_EQ(answer_in(client.receive().value()).texels_size(), 3);
}

TEST(Sampling, StopsWhenTheClientLeavesAndSaysWhenItIsTooMuch) {
    ServerOptions options = test::quick_options();
    options.samples.threads = 1;
    options.samples.waiting_requests = 2;
    RunningServer running{options};
    const SampleMetrics& metrics = running.server->samples().metrics();
    const std::string body = squares(2, 3).SerializeAsString();
    {
        RawClient first = running.client(), second = running.client(), third = running.client();
        ASSERT_TRUE(first.send(post("gated", protobuf_type, body)));  // its texels never come
        ASSERT_TRUE(test::eventually([&] { return running.gated->begun > 0; }));
        ASSERT_TRUE(second.send(post("gated", protobuf_type, body)));
        ASSERT_TRUE(test::eventually([&] {
            running.server->samples().update_gauges();
            return metrics.waiting.Value() == 2;
        }));
        const Reply refused = sample(third, "gated", protobuf_type, body);
        EXPECT_EQ(refused.status, 503);
        EXPECT_EQ(refused["retry-after"], "1");
        EXPECT_EQ(third.get("/healthz").value().status, 200);
    }
    EXPECT_TRUE(test::eventually([&] { return metrics.requests(SampleResult::cancelled) == 2; }));
    EXPECT_TRUE(test::eventually([&] { return running.gated->stopped > 0; }));
    RawClient client = running.client();
    EXPECT_EQ(sample(client, "board", protobuf_type, body).status, 200);
}

TEST(Sampling, EndsAtTheDeadline) {
    ServerOptions options = test::quick_options();
    options.samples.deadline = std::chrono::milliseconds{50};
    RunningServer running{options};
    RawClient client = running.client();
    const Reply late = sample(client, "gated", protobuf_type, squares(1, 2).SerializeAsString());
    EXPECT_EQ(late.status, 503);
    EXPECT_NE(late.body.find("fewer footprints"), std::string::npos);
    EXPECT_EQ(client.get("/healthz").value().status, 200);
}

TEST(Sampling, IsCountedByFilter) {
    RunningServer running;
    RawClient client = running.client();
    sample(client, "board", protobuf_type, squares(7, 2, "bilinear").SerializeAsString());
    const std::string metrics = client.get("/metrics").value().body;
    for (const char* line :
         {"tessera_samples_total{filter=\"bilinear\"} 7",
          "tessera_sample_requests_total{result=\"answered\"} 1",
          "tessera_sample_texels_total{filter=\"bilinear\"} ",
          "tessera_sample_seconds_total{filter=\"bilinear\"} ", "tessera_sample_page_bytes "})
        EXPECT_NE(metrics.find(line), std::string::npos) << line;
}

TEST(Sampling, AReloadLetsGoOfTheOldScenes) {
    RunningServer running;
    RawClient client = running.client();
    sample(client, "board", protobuf_type, squares(1, 2).SerializeAsString());
    running.server->samples().update_gauges();
    EXPECT_GT(running.server->samples().metrics().page_bytes.Value(), 0);
    running.publish();
    running.server->samples().update_gauges();
    EXPECT_EQ(running.server->samples().metrics().page_bytes.Value(), 0);
    EXPECT_EQ(running.server->samples().metrics().samplers.Value(), 0);
}

}  // namespace
}  // namespace tessera
