// Pages over a real socket: what every client sees.
#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/end_to_end/server/running_server.h"

namespace tessera {
namespace {

using test::RawClient;
using test::Reply;
using test::RunningServer;

TEST(Pages, ComeWithWhatTheirEvaluationDid) {
    RunningServer running;
    running.gated->open();
    const Reply page = running.client().get(test::gated_page).value();
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page["content-type"], "image/png");
    EXPECT_EQ(page["tessera-method"], "gated");
    EXPECT_EQ(page["tessera-bound"], "0.25");
    EXPECT_EQ(page["tessera-confidence"], "0.5");
    EXPECT_EQ(page["tessera-work"], "7");
    EXPECT_EQ(page["tessera-revision"], "0");
    EXPECT_EQ(page["tessera-level"], "0");
    for (const char* part : {"queue;dur=", "evaluate;dur=", "encode;dur="})
        EXPECT_NE(page["server-timing"].find(part), std::string::npos);
    EXPECT_EQ(page.fields.count("set-twice"), 0u);
}

TEST(Pages, AreForEveryOriginAndEveryCache) {
    RunningServer running;
    running.gated->open();
    RawClient client = running.client();
    for (const std::string& target :
         {test::gated_page, std::string{"/scenes"}, std::string{"/nothing"}, std::string{"/"}}) {
        const Reply reply = client.get(target).value();
        EXPECT_EQ(reply["access-control-allow-origin"], "*") << target;
        EXPECT_EQ(reply["timing-allow-origin"], "*") << target;
        EXPECT_EQ(reply["cross-origin-resource-policy"], "cross-origin") << target;
        EXPECT_EQ(reply["x-content-type-options"], "nosniff") << target;
        EXPECT_TRUE(reply["date"].ends_with(" GMT")) << target;
        EXPECT_EQ(reply["set-cookie"], "");
    }
    EXPECT_EQ(client.get(test::gated_page).value()["vary"], "");
    EXPECT_EQ(client.get("/nothing").value()["cache-control"], "no-store");
    EXPECT_EQ(client.get("/nothing").value()["etag"], "");
    const Reply options = client.get(test::gated_page, "Origin: http://a\r\n", "OPTIONS").value();
    EXPECT_EQ(options.status, 204);
    EXPECT_EQ(options["allow"], "GET, HEAD, OPTIONS");
    EXPECT_EQ(options["access-control-allow-methods"], "GET, HEAD, OPTIONS");
    EXPECT_EQ(client.get("*", "", "OPTIONS").value().status, 204);
}

TEST(Pages, CostNothingToRevalidateAndToLookAt) {
    RunningServer running;
    RawClient client = running.client();
    const Reply head = client.get(test::gated_page, "", "HEAD").value();
    EXPECT_EQ(head.status, 200);
    const std::string tag = head["etag"];
    ASSERT_GT(tag.size(), 10u);
    for (const std::string& known : {tag, "W/" + tag, "\"x\", " + tag, std::string{"*"}}) {
        const Reply same = client.get(test::gated_page, "If-None-Match: " + known + "\r\n").value();
        EXPECT_EQ(same.status, 304) << known;
        EXPECT_EQ(same["etag"], tag);
        EXPECT_EQ(same["cache-control"], "no-cache");
        EXPECT_EQ(same["content-length"], "");
    }
    EXPECT_EQ(running.gated->begun, 0);
    running.gated->open();
    const Reply page = client.get(test::gated_page, "If-None-Match: \"other\"\r\n").value();
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page["etag"], tag);
    const Reply known = client.get(test::gated_page, "", "HEAD").value();
    EXPECT_EQ(known["content-length"], std::to_string(page.body.size()));
    EXPECT_EQ(client.get(test::gated_page).value().body, page.body);  // nothing was left on the connection
    EXPECT_EQ(running.gated->begun, 1);
}

TEST(Pages, RawTexelsAreCompressedForThoseWhoAskAndTaggedApart) {
    RunningServer running;
    RawClient client = running.client();
    const std::string target = "/scenes/board/20/5/7.rgba?gutter=4";
    const Reply raw = client.get(target).value();
    ASSERT_EQ(raw.body.size(), 264u * 264 * 4);
    EXPECT_EQ(raw["content-type"], "application/octet-stream");
    EXPECT_EQ(raw["vary"], "Accept-Encoding");
    const Reply packed = client.get(target, "Accept-Encoding: gzip, zstd;q=0.5\r\n").value();
    EXPECT_EQ(packed["content-encoding"], "zstd");
    EXPECT_EQ(packed["vary"], "Accept-Encoding");
    EXPECT_NE(packed["etag"], raw["etag"]);
    std::string back(raw.body.size(), '\0');
    ASSERT_EQ(ZSTD_decompress(back.data(), back.size(), packed.body.data(), packed.body.size()), back.size());
    EXPECT_EQ(back, raw.body);
    EXPECT_EQ(client.get(target, "Accept-Encoding: zstd;q=0\r\n").value()["content-encoding"], "");
    EXPECT_EQ(client.get("/scenes/board/20/5/7.png", "Accept-Encoding: zstd\r\n").value()["content-encoding"],
              "");
    EXPECT_EQ(client.get(target, "If-None-Match: " + raw["etag"] + "\r\n").value()["vary"],
              "Accept-Encoding");
}

TEST(Pages, AtARevisionStayForEver) {
    RunningServer running;
    RawClient client = running.client();
    const std::string base = "/scenes/board/r0-b0a4db0a4db0a4d0/";
    const Reply pinned = client.get(base + "20/5/7.png?gutter=1").value();
    EXPECT_EQ(pinned.status, 200);
    EXPECT_EQ(pinned["cache-control"], "public, max-age=31536000, immutable");
    const Reply now = client.get("/scenes/board/20/5/7.png?gutter=1").value();
    EXPECT_EQ(now["cache-control"], "no-cache");
    EXPECT_EQ(now["etag"], pinned["etag"]);
    EXPECT_EQ(now.body, pinned.body);
    EXPECT_EQ(client.get(base + "20/5/7.png", "If-None-Match: *\r\n").value()["cache-control"],
              "public, max-age=31536000, immutable");

    for (const char* wrong :
         {"/scenes/board/r0-0000000000000000/20/5/7.png", "/scenes/board/r1-b0a4db0a4db0a4d0/20/5/7.png"}) {
        const Reply missing = client.get(wrong).value();
        EXPECT_EQ(missing.status, 404) << wrong;
        EXPECT_EQ(missing["cache-control"], "no-store") << wrong;
    }
    const Reply moved = client.get(base + "20/5/7.png?accuracy=fast&gutter=2").value();
    EXPECT_EQ(moved.status, 308);
    EXPECT_EQ(moved["location"], base + "20/5/7.png?gutter=2&accuracy=fast");
    EXPECT_EQ(client.get(moved["location"]).value().status, 200);
}

TEST(Pages, TheWindowEndsWhereTheExtentDoes) {
    RunningServer running;
    RawClient client = running.client();
    EXPECT_EQ(client.get("/scenes/grey/0/0/0.png").value()["tessera-level"], "20");
    EXPECT_EQ(client.get("/scenes/grey/20/1048575/1048575.png").value()["tessera-level"], "0");
    for (const char* outside :
         {"/scenes/grey/0/1/0.png", "/scenes/grey/20/1048576/0.png", "/scenes/grey/21/0/0.png",
          "/scenes/grey/5/-1/0.png", "/scenes/grey/5/0/99999999999999999999999.png"})
        EXPECT_EQ(client.get(outside).value().status, 404) << outside;
}

TEST(Pages, TwoServersAndAnyNumberOfThreadsGiveTheSameBytes) {
    ServerOptions one = test::quick_options(), eight = test::quick_options();
    one.pages.threads = one.io_threads = 1;
    eight.pages.threads = 8;
    RunningServer a{one}, b{eight};
    a.gated->open();
    b.gated->open();
    RawClient from_a = a.client(), from_b = b.client();
    for (const std::string& scene : std::vector<std::string>{"gated", "board", "grey"})
        for (const std::string& format : std::vector<std::string>{"png", "jpg", "webp", "rgba"})
            for (const std::string& place : std::vector<std::string>{"20/5/7.", "12/99/3."}) {
                const std::string target = "/scenes/" + scene + "/" + place + format;
                const Reply first = from_a.get(target).value(), second = from_b.get(target).value();
                EXPECT_EQ(first.status, 200) << target;
                EXPECT_EQ(first.body, second.body) << target;
                EXPECT_EQ(first["etag"], second["etag"]) << target;
            }
}

TEST(Scenes, AreDescribedInTheSchemasWords) {
    RunningServer running;
    RawClient client = running.client();
    const Reply list = client.get("/scenes").value();
    EXPECT_EQ(list["content-type"], "application/json");
    EXPECT_NE(list.body.find("\"tilejson\": \"/scenes/board\""), std::string::npos) << list.body;
    const Reply tiles = client.get("/scenes/board").value();
    EXPECT_NE(tiles.body.find("\"http://test/scenes/board/{z}/{x}/{y}.png\""), std::string::npos)
        << tiles.body;
    EXPECT_NE(tiles.body.find("\"/scenes/board/r0-b0a4db0a4db0a4d0/{z}/{x}/{y}\""), std::string::npos);
    EXPECT_EQ(client.get("/scenes/board", "If-None-Match: " + tiles["etag"] + "\r\n").value().status, 304);
    const Reply secure = client.get("/scenes/board", "X-Forwarded-Proto: https\r\n").value();
    EXPECT_NE(secure.body.find("\"https://test/scenes/board/"), std::string::npos);
    EXPECT_NE(secure["etag"], tiles["etag"]);
}

TEST(Scenes, AreReplacedWithoutAGap) {
    RunningServer running;
    running.gated->open();
    RawClient client = running.client();
    const std::string tag = client.get(test::gated_page).value()["etag"];
    running.publish("fedcba9876543210");
    const Reply after = client.get(test::gated_page, "If-None-Match: " + tag + "\r\n").value();
    EXPECT_EQ(after.status, 200);
    EXPECT_NE(after["etag"], tag);
}

TEST(Health, TellsLivenessFromReadiness) {
    RunningServer running{test::quick_options(), false};
    RawClient client = running.client();
    EXPECT_EQ(client.get("/healthz").value().status, 200);
    const Reply loading = client.get("/readyz").value();
    EXPECT_EQ(loading.status, 503);
    EXPECT_EQ(loading["retry-after"], "1");
    EXPECT_EQ(client.get("/scenes").value().status, 503);
    running.publish();
    EXPECT_EQ(client.get("/readyz").value().status, 200);
    EXPECT_EQ(client.get("/scenes").value().status, 200);
}

TEST(Metrics, CountPagesByLevelAndResult) {
    RunningServer running;
    RawClient client = running.client();
    for (int i = 0; i < 3; ++i) client.get("/scenes/board/18/1/2.png");
    const Reply metrics = client.get("/metrics").value();
    EXPECT_TRUE(metrics["content-type"].starts_with("text/plain; version=0.0.4"));
    for (const char* line :
         {"tessera_page_requests_total{level=\"2\",result=\"cached\"} 2\n",
          "tessera_page_requests_total{level=\"2\",result=\"evaluated\"} 1\n",
          "tessera_http_answers_total{status=\"200\"} 3\n", "tessera_http_connections 1\n"})
        EXPECT_NE(metrics.body.find(line), std::string::npos) << line;
}

}  // namespace
}  // namespace tessera
