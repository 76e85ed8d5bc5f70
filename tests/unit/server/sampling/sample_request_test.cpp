#include "server/sampling/sample_request.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "proto/sample.pb.h"

#include "shared/wire/json.h"

namespace tessera {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

proto::SampleRequest two_footprints() {
    proto::SampleRequest request;
    proto::SampleFootprint& first = *request.add_footprints();
    first.set_origin_x(std::int64_t{1} << 38);
    first.set_origin_y(-7);
    first.mutable_axes()->set_x(0.5);
    first.mutable_axes()->set_along_x(4);
    first.mutable_axes()->set_across_y(2);
    proto::FootprintCorners& corners = *request.add_footprints()->mutable_corners();
    for (const double x : {0.0, 3.0, 3.0, 0.0}) corners.add_x(x);
    for (const double y : {0.0, 0.0, 1.0, 1.0}) corners.add_y(y);
    return request;
}

template <class Change>
std::string refused(Change change) {
    proto::SampleRequest request = two_footprints();
    change(request);
    const auto read = read_sample_request(request.SerializeAsString(), WireCoding::protobuf);
    if (read) return "taken";
    EXPECT_EQ(read.error().code, ErrorCode::malformed_request);
    return read.error().detail;
}

TEST(SampleRequest, IsTheSameInBothCodings) {
    proto::SampleRequest given = two_footprints();
    given.set_filter("exact");
    given.set_accuracy("fast");
    given.set_channels("normal");
    given.set_slice(-3);
    for (const WireCoding coding : {WireCoding::protobuf, WireCoding::json}) {
        const auto read = read_sample_request(
            coding == WireCoding::json ? write_brief_json(given) : given.SerializeAsString(), coding);
        ASSERT_TRUE(read) << read.error().detail;
        ASSERT_EQ(read->footprints.size(), 2u);
        EXPECT_EQ(read->footprints[0].x, std::int64_t{1} << 38);
        EXPECT_EQ(read->footprints[0].y, -7);
        EXPECT_EQ(read->footprints[0].corners[0], (TexelPoint{-1.5, -1}));
        EXPECT_EQ(read->footprints[0].corners[2], (TexelPoint{2.5, 1}));
        EXPECT_EQ(read->footprints[1].corners[2], (TexelPoint{3, 1}));
        EXPECT_EQ(read->filter, filter_named("exact"));
        EXPECT_EQ(read->accuracy, Accuracy::fast);
        EXPECT_FALSE(read->max_error);
        EXPECT_EQ(read->channels, ChannelSet::normal);
        EXPECT_EQ(read->slice, -3);
    }
}

TEST(SampleRequest, TakesWhatAPixelSees) {
    const auto read = read_sample_request(R"({"max_error": 0.5, "footprints": [{"origin_x": "1000", "rays": {
        "origin": [0, 0, 1], "direction": [0, 1, -1], "direction_dx": [0.02, 0, 0], "direction_dy": [0, 0, -0.02],
        "point": [0, 1, 0], "per_s": [0.01, 0, 0], "per_t": [0, -0.01, 0], "s": 7.5, "t": 9}}]})",
                                          WireCoding::json);
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->max_error, 0.5);
    EXPECT_EQ(read->footprints[0].x, 1000);
    EXPECT_NEAR(axes_of(read->footprints[0]).centre.x, 7.5, 1e-9);
    EXPECT_NEAR(area_of(read->footprints[0]), 4, 0.01);
}

TEST(SampleRequest, NamesTheFootprintAndTheFieldThatAreWrong) {
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(1)->clear_shape(); }),
              "footprints[1] has no shape; give axes, corners or rays");
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(0)->mutable_axes()->set_along_y(nan); }),
              "footprints[0].axes.along_y: is not a finite number");
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(1)->mutable_corners()->set_x(2, nan); }),
              "footprints[1].corners: corner 2 is not a finite number");
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(1)->mutable_corners()->set_y(2, 0x1p41); }),
              "footprints[1].corners: corner 2 lies beyond 2^40 texels from the origin");
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(1)->mutable_corners()->add_y(0); }),
              "footprints[1].corners.y: four numbers, not 5");
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(0)->set_origin_y(-(std::int64_t{1} << 40) - 1); }),
              "footprints[0].origin_y: lies beyond ±2^40 texels");
    const std::string not_convex =
        refused([](auto& r) { r.mutable_footprints(1)->mutable_corners()->set_x(2, -9); });
    EXPECT_TRUE(not_convex.starts_with("footprints[1].corners: corner")) << not_convex;
    EXPECT_NE(not_convex.find("not convex"), std::string::npos) << not_convex;
    EXPECT_EQ(refused([](auto& r) { r.mutable_footprints(0)->mutable_rays()->add_origin(1); }),
              "footprints[0].rays.origin: three numbers, not 1");
    EXPECT_EQ(refused([](auto& r) {
                  proto::FootprintRays& rays = *r.mutable_footprints(0)->mutable_rays();
                  for (int i = 0; i < 3; ++i) {
                      rays.add_origin(0);
                      rays.add_direction(0);
                      rays.add_point(1);
                      rays.add_per_s(i == 0);
                      rays.add_per_t(i == 1);
                  }
              }),
              "footprints[0].rays.direction: is 0, or too small to tell its direction");
}

TEST(SampleRequest, NamesTheChoiceThatIsWrong) {
    const auto begins = [](const std::string& text, const char* with) {
        EXPECT_TRUE(text.starts_with(with)) << text;
    };
    begins(refused([](auto& r) { r.set_filter("gaussian"); }), "filter: there is no \"gaussian\"");
    begins(refused([](auto& r) {
               r.set_filter("exact");
               r.set_max_error(1);
           }),
           "max_error: chooses the filter");
    begins(refused([](auto& r) { r.set_accuracy("best"); }), "accuracy:");
    begins(refused([](auto& r) { r.set_max_error(-1); }), "max_error:");
    begins(refused([](auto& r) { r.set_max_error(nan); }), "max_error:");
    begins(refused([](auto& r) { r.set_max_error(256); }), "max_error:");
    begins(refused([](auto& r) { r.set_channels("gloss"); }), "channels:");
    begins(refused([](auto& r) { r.set_slice((std::int64_t{1} << 40) + 1); }), "slice:");
    begins(refused([](auto& r) { r.clear_footprints(); }), "footprints: there are none");
    begins(refused([](auto& r) { r.set_filter(std::string(2000, 'a')); }),
           "the fields beside the footprints");
    begins(refused([](auto& r) {
               for (std::size_t i = 0; i < max_sample_footprints; ++i)
                   r.add_footprints()->mutable_axes()->set_x(0);
           }),
           "footprints: more than 65536");
}

TEST(SampleRequest, RefusesFieldsItDoesNotKnow) {
    std::string body = two_footprints().SerializeAsString();
    EXPECT_TRUE(read_sample_request(body, WireCoding::protobuf));
    EXPECT_FALSE(read_sample_request(body + "\x78\x01", WireCoding::protobuf));  // field 15, a number
    const auto inside = read_sample_request(std::string{"\x0a\x02\x78\x01"}, WireCoding::protobuf);
    ASSERT_FALSE(inside);
    EXPECT_EQ(inside.error().detail, "footprints[0] has a field that is not known here");
    const auto json = read_sample_request(R"({"footprints": [{"axes": {"z": 1}}]})", WireCoding::json);
    ASSERT_FALSE(json);
    EXPECT_NE(json.error().detail.find("footprints[0]"), std::string::npos) << json.error().detail;
}

TEST(SampleRequest, RefusesWhatIsNoMessage) {
    const std::string good = two_footprints().SerializeAsString();
    for (std::size_t size = 1; size < good.size(); ++size) {
        const auto read = read_sample_request(std::string_view{good}.substr(0, size), WireCoding::protobuf);
        if (read) {
            EXPECT_EQ(read->footprints.size(), 1u) << size;  // cut between the two
        }
    }
    for (const char* text : {"", "{", "[]", "null", "{\"footprints\": 1}", "{} {}", "\xff\xfe"})
        EXPECT_FALSE(read_sample_request(text, WireCoding::json)) << text;
    for (const char* text : {"", "x", "\x0a", "\x0a\xff\xff\xff\xff\x0f", "\x0b", "\x07"})
        EXPECT_FALSE(read_sample_request(text, WireCoding::protobuf)) << text;
    std::string deep;
    for (int i = 0; i < 100'000; ++i) deep += "{\"footprints\":[";
    EXPECT_FALSE(read_sample_request(deep, WireCoding::json));
}

TEST(SampleRequest, SmallFootprintsInALargeBodyEndAtTheLimit) {
    std::string body;
    for (int i = 0; i < 4'000'000; ++i)
        body.append("\x0a\x02\x1a\x00", 4);  // axes without a number: one texel point
    const auto read = read_sample_request(body, WireCoding::protobuf);
    ASSERT_FALSE(read);
    EXPECT_TRUE(read.error().detail.starts_with("footprints: more than")) << read.error().detail;
}

}  // namespace
}  // namespace tessera
