// `max_error=` of pages over a real socket: what is kept by caches, and what is not.
#include <gtest/gtest.h>

#include "tests/end_to_end/server/running_server.h"
#include "tests/unit/server/pages/stepped_texture.h"

namespace tessera {
namespace {

using test::RawClient;
using test::Reply;

const std::string page = "/scenes/stepped/3/1/2.png",
                  pinned = "/scenes/stepped/r0-57e9957e9957e995/3/1/2.png";

class PageLimits : public testing::Test {
  protected:
    PageLimits() {
        auto catalog = std::make_shared<Catalog>();
        catalog->scenes.emplace(
            "stepped",
            test::make_scene("stepped", std::make_shared<test::SteppedTexture>(), "57e9957e9957e995"));
        running.server->publish(std::move(catalog), WebFiles::plain());
    }

    test::RunningServer running{test::quick_options(), false};
    RawClient client = running.client();
};

TEST_F(PageLimits, ComeFromTheCheapestAccuracyThatKeepsThem) {
    const struct {
        const char* limit;
        const char* accuracy;
        const char* bound;
    } cases[] = {{"255", "fast", "4"}, {"4", "fast", "4"}, {"3.9", "high", "1"}, {"0.5", "exact", "0.25"}};
    std::string tags;
    for (const auto& [limit, accuracy, bound] : cases) {
        const Reply reply = client.get(page + "?max_error=" + limit).value();
        EXPECT_EQ(reply.status, 200);
        EXPECT_EQ(reply["tessera-accuracy"], accuracy) << limit;
        EXPECT_EQ(reply["tessera-bound"], bound) << limit;
        EXPECT_EQ(reply["tessera-max-error"], limit);
        EXPECT_EQ(reply["cache-control"], "no-cache");
        ASSERT_GT(reply["etag"].size(), 10u);
        EXPECT_EQ(tags.find(reply["etag"]), std::string::npos) << "the limit is part of the entity tag";
        tags += reply["etag"];
        const Reply same =
            client.get(page + "?max_error=" + limit, "If-None-Match: " + reply["etag"] + "\r\n").value();
        EXPECT_EQ(same.status, 304);
        EXPECT_EQ(same["etag"], reply["etag"]);
    }
    EXPECT_EQ(client.get(page).value()["tessera-max-error"], "");
}

TEST_F(PageLimits, ThatNoAccuracyKeepsGiveAPageThatNobodyMayStore) {
    for (const std::string& target : {page + "?max_error=0.2", pinned + "?max_error=0.2"})
        for (int time = 0; time < 2; ++time) {  // evaluated, and from the server's own cache
            const Reply reply = client.get(target).value();
            EXPECT_EQ(reply.status, 200);
            EXPECT_EQ(reply["tessera-accuracy"], "exact");
            EXPECT_EQ(reply["tessera-bound"], "0.25");
            EXPECT_EQ(reply["cache-control"], "no-store") << target;
            EXPECT_EQ(reply["etag"], "") << target;
            EXPECT_EQ(client.get(target, "If-None-Match: *\r\n").value().status, 200);
        }
}

TEST_F(PageLimits, HeadPromisesNothingBeforeThePageIsMade) {
    const Reply before = client.get(page + "?max_error=1", "", "HEAD").value();
    EXPECT_EQ(before.status, 200);
    EXPECT_EQ(before["etag"], "");
    EXPECT_EQ(before["cache-control"], "no-store");
    const Reply made = client.get(page + "?max_error=1").value();
    const Reply after = client.get(page + "?max_error=1", "", "HEAD").value();
    EXPECT_EQ(after["etag"], made["etag"]);
    EXPECT_EQ(after["cache-control"], "no-cache");
}

TEST_F(PageLimits, HaveOneAddress) {
    EXPECT_EQ(client.get(pinned + "?max_error=1").value().status, 200);
    EXPECT_EQ(client.get(pinned + "?max_error=1").value()["cache-control"],
              "public, max-age=31536000, immutable");
    const Reply moved = client.get(pinned + "?max_error=1.50&accuracy=fast&gutter=2").value();
    EXPECT_EQ(moved.status, 308);
    EXPECT_EQ(moved["location"], pinned + "?gutter=2&max_error=1.5");
    EXPECT_EQ(client.get(page + "?max_error=1e3").value().status, 400);
}

}  // namespace
}  // namespace tessera
