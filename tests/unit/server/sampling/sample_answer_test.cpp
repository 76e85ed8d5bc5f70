#include "server/sampling/sample_answer.h"

#include <limits>

#include <gtest/gtest.h>

#include "proto/sample.pb.h"

#include "shared/wire/json.h"

namespace tessera {
namespace {

const SamplePlan three_steps{{{{.kind = FilterKind::nearest}, Accuracy::fast},
                              {{.kind = FilterKind::exact}, Accuracy::fast},
                              {{.kind = FilterKind::exact}, Accuracy::exact}},
                             1};

std::string written(WireCoding coding) {
    const FilteredSample samples[] = {{{0.1F, 0.25F, 1, 1}, 0.1, 1, 7},
                                      {{0, 0.5F, 1.0F / 3, 0.75F}, 2.5, 1 - 1e-9, std::uint64_t{1} << 40}};
    const std::uint8_t steps[] = {2, 1};
    return write_sample_answer(three_steps, samples, steps, 42, std::chrono::microseconds{1500}, coding);
}

TEST(SampleAnswer, IsTheSameInBothCodings) {
    proto::SampleAnswer binary, text;
    ASSERT_TRUE(binary.ParseFromString(written(WireCoding::protobuf)));
    const auto read = read_json(written(WireCoding::json), "answer", text);
    ASSERT_TRUE(read) << read.error().detail << written(WireCoding::json);
    EXPECT_EQ(binary.SerializeAsString(), text.SerializeAsString());
    EXPECT_EQ(binary.colors_size(), 8);
    EXPECT_EQ(binary.colors(6), 1.0F / 3);
    EXPECT_EQ(binary.revision(), 42u);
    EXPECT_EQ(binary.milliseconds(), 1.5);
    EXPECT_EQ(binary.texels(0), 7u);
    EXPECT_EQ(binary.texels(1), std::numeric_limits<std::uint32_t>::max());
}

TEST(SampleAnswer, NamesEachFilterThatWasUsedOnce) {
    proto::SampleAnswer answer;
    ASSERT_TRUE(answer.ParseFromString(written(WireCoding::protobuf)));
    ASSERT_EQ(answer.filters_size(), 1);
    EXPECT_EQ(answer.filters(0), "exact");
    EXPECT_EQ(answer.filter(0), 0u);
    EXPECT_EQ(answer.filter(1), 0u);
}

TEST(SampleAnswer, RoundsWhatItSaysOfAnErrorToTheSafeSide) {
    proto::SampleAnswer answer;
    ASSERT_TRUE(answer.ParseFromString(written(WireCoding::protobuf)));
    EXPECT_GE(static_cast<double>(answer.bound_codes(0)), 0.1);
    EXPECT_LT(static_cast<double>(answer.bound_codes(0)), 0.1 + 1e-8);
    EXPECT_EQ(answer.confidence(0), 1.0F);
    EXPECT_LT(answer.confidence(1), 1.0F);  // to the nearest float it would be certain
}

TEST(SampleAnswer, HasAFootprintsColourALine) {
    EXPECT_NE(written(WireCoding::json).find("\n    0.1, 0.25, 1, 1,\n"), std::string::npos)
        << written(WireCoding::json);
}

}  // namespace
}  // namespace tessera
