#include "server/http/media_type.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr auto json = WireCoding::json, protobuf = WireCoding::protobuf;

TEST(MediaType, TellsTheCoding) {
    EXPECT_EQ(wire_coding_of("application/json"), json);
    EXPECT_EQ(wire_coding_of("Application/JSON; charset=utf-8"), json);
    EXPECT_EQ(wire_coding_of("application/x-protobuf"), protobuf);
    EXPECT_EQ(wire_coding_of(" application/protobuf ;messageType=\"tessera.proto.SampleRequest\""), protobuf);
    for (const char* other : {"", "text/plain", "application/jsonp", "application/*", "*/*", "json"})
        EXPECT_FALSE(wire_coding_of(other)) << other;
}

TEST(MediaType, IsTheOneThatIsLikedBest) {
    const struct {
        const char* accept;
        std::optional<WireCoding> of_json, of_protobuf;
    } cases[] = {
        {"", json, protobuf},
        {"*/*", json, protobuf},
        {"application/*;q=0.1", json, protobuf},
        {"application/json", json, json},
        {"application/x-protobuf, */*;q=0.5", protobuf, protobuf},
        {"text/html, application/json;q=0.9, */*;q=0.8", json, json},
        {"application/json;q=0, */*", protobuf, protobuf},
        {"application/json;q=0.5, application/x-protobuf;q=0.5", json, protobuf},
        {"text/html", {}, {}},
        {"application/json;q=0", {}, {}},
        {"application/json;q=nonsense", {}, {}},
    };
    for (const auto& [accept, of_json, of_protobuf] : cases) {
        EXPECT_EQ(accepted_coding(accept, json), of_json) << accept;
        EXPECT_EQ(accepted_coding(accept, protobuf), of_protobuf) << accept;
    }
}

}  // namespace
}  // namespace tessera
