#include "server/http/address.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

Parsed<PageAddress> page_at(std::string_view path) {
    const auto segments = path_segments(path);
    if (!segments) return segments.error();
    if (!is_page_address(*segments)) return Refusal{404, "not a page", false};
    return page_address(*segments);
}

TEST(PathSegments, AreDecodedOnce) {
    EXPECT_EQ(path_segments("/a/b%20c/%2541").value(), (std::vector<std::string>{"a", "b c", "%41"}));
    EXPECT_EQ(path_segments("/").value(), std::vector<std::string>{""});
    EXPECT_EQ(path_segments("/a//b/").value(), (std::vector<std::string>{"a", "", "b", ""}));
}

TEST(PathSegments, RefuseWhatCouldLeaveAFolder) {
    for (const char* path : {"/..", "/a/../b", "/.", "/%2e%2e", "/%2E.", "/a%2fb", "/a%5Cb", "/%00", "/%1f",
                             "/%7f", "/%c0%ae", "/%", "/%4", "/%4g"})
        EXPECT_EQ(path_segments(path).error().status, 400u) << path;
}

TEST(PageAddress, NamesScenePlaceAndFormat) {
    const PageAddress now = page_at("/scenes/moss/20/1048575/7.webp").value();
    EXPECT_EQ(now.scene, "moss");
    EXPECT_FALSE(now.pin.has_value());
    EXPECT_EQ(now.z, 20u);
    EXPECT_EQ(now.x, 1048575u);
    EXPECT_EQ(now.y, 7u);
    EXPECT_EQ(now.format, PageFormat::webp);
    const PageAddress pinned = page_at("/scenes/moss/r12-0123456789abcdef/0/0/0.rgba").value();
    EXPECT_EQ(pinned.pin->revision, 12u);
    EXPECT_EQ(pinned.pin->fingerprint, "0123456789abcdef");
}

TEST(PageAddress, TakesNumbersBeyondEveryExtentForPagesThatAreNotThere) {
    for (const char* path : {"/scenes/a/1/-1/0.png", "/scenes/a/1/99999999999999999999/0.png"})
        EXPECT_GT(page_at(path).value().x, std::uint64_t{1} << 30) << path;
}

TEST(PageQuery, HasOneCanonicalForm) {
    EXPECT_EQ(page_query("").value().canonical(), "");
    EXPECT_EQ(page_query("gutter=0&accuracy=high").value().canonical(), "");
    EXPECT_EQ(page_query("accuracy=exact&gutter=4").value().canonical(), "?gutter=4&accuracy=exact");
    EXPECT_EQ(page_query("accuracy=fast").value().canonical(), "?accuracy=fast");
    EXPECT_EQ(page_query("channels=albedo").value().canonical(), "");
    EXPECT_EQ(page_query("channels=normal&accuracy=exact&gutter=4").value().canonical(),
              "?gutter=4&accuracy=exact&channels=normal");
    EXPECT_EQ(page_query("channels=normal&max_error=0.50&gutter=1").value().canonical(),
              "?gutter=1&max_error=0.5&channels=normal");
    EXPECT_EQ(page_query("max_error=2&accuracy=exact").value().canonical(), "?max_error=2");
    EXPECT_EQ(page_query("slice=0").value().canonical(), "");
    EXPECT_EQ(page_query("slice=-12&channels=normal").value().canonical(), "?channels=normal&slice=-12");
    EXPECT_EQ(page_query("slice=1099511627776").value().slice, max_slice);
    EXPECT_EQ(page_query("step=0").value().canonical(), "");
    EXPECT_EQ(page_query("step=-3&slice=2&gutter=1").value().canonical(), "?gutter=1&slice=2&step=-3");
    EXPECT_EQ(page_query("step=1000000000000000").value().step, 1'000'000'000'000'000);
    EXPECT_EQ(page_query("step=-4611686018427387904").value().step, -max_step);
    EXPECT_EQ(page_query("parameter=0").value().canonical(), "");
    EXPECT_EQ(page_query("parameter=0.2500&step=7").value().canonical(), "?step=7&parameter=0.25");
    EXPECT_EQ(page_query("parameter=1").value().parameter, 65536);
    for (const std::int32_t parameter : {1, 2, 21845, 32768, 65535}) {
        PageQuery query;
        query.parameter = parameter;
        EXPECT_EQ(page_query(query.canonical().substr(1)).value().parameter, parameter);
    }
}

TEST(PageQuery, RefusesWhatItDoesNotKnow) {
    for (const char* query : {"gutter=17",
                              "gutter=04",
                              "gutter",
                              "gutter=1&gutter=1",
                              "Gutter=1",
                              "accuracy=",
                              "&",
                              "step=3",
                              "gutter=1&&accuracy=fast",
                              "gutter=%34",
                              "channels=",
                              "channels=Normal",
                              "channels=normal&channels=normal",
                              "slice=",
                              "slice=-0",
                              "slice=+1",
                              "slice=01",
                              "slice=1.5",
                              "slice=--1",
                              "slice=1099511627777",
                              "slice=-1099511627777",
                              "slice=99999999999999999999",
                              "slice=1&slice=1",
                              "step=",
                              "step=1e3",
                              "step=-0",
                              "step=4611686018427387905",
                              "step=-9223372036854775809",
                              "step=1&step=1",
                              "parameter=",
                              "parameter=1.5",
                              "parameter=1.0001",
                              "parameter=-0.5",
                              "parameter=.5",
                              "parameter=0.",
                              "parameter=1e-3",
                              "parameter=0.5&parameter=0.5",
                              "max_error=",
                              "max_error=-1",
                              "max_error=1e-3",
                              "max_error=256",
                              "max_error=1&max_error=1"})
        EXPECT_EQ(page_query(query).error().status, 400u) << query;
}

TEST(PageQuery, ListsTheChannelSetsThereAre) {
    const std::string why = page_query("channels=specular").error().why;
    for (const ChannelSet set : channel_sets) EXPECT_NE(why.find(name_of(set)), std::string::npos) << why;
}

}  // namespace
}  // namespace tessera
