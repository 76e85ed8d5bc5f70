// A surface of four aligned images over a real socket: every channel set is a page of its own.
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/asset_file.h"
#include "shared/page/channel_set.h"
#include "tests/end_to_end/server/running_server.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/synthetic_channels.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using test::RawClient;
using test::Reply;
using testing::HasSubstr;

/// A server of the scene `surface`, read from a folder like any other, and of `plain`, which has its colour
/// alone.
class ChannelPages : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<tests::TemporaryFolder>();
        ExchangeAsset asset = tests::make_synthetic_asset({});
        write("plain", asset);
        tests::add_bumps(asset, 60);
        tests::add_grey_noise(asset, "roughness", 60, 90);
        tests::add_grey_noise(asset, "height", 0, 255);
        write("surface", asset);
        server = Server::start(test::quick_options()).value();
        server->publish(std::make_shared<Catalog>(load_catalog(folder->path).value()), WebFiles::plain());
    }
    static void TearDownTestSuite() {
        server.reset();
        folder.reset();
    }
    static void write(const std::string& id, const ExchangeAsset& asset) {
        std::filesystem::create_directories(folder->path / id);
        ASSERT_TRUE(write_exchange_asset(folder->path / id / "asset", asset, {}));
        std::ofstream{folder->path / id / "scene.json"}
            << R"({"extent_log2_pages": 10, "content_exchange": {"asset": "asset", "types": 64, "unblended": true}})";
    }

    static inline std::unique_ptr<tests::TemporaryFolder> folder;
    static inline std::unique_ptr<Server> server;
    RawClient client{server->port()};
};

/// Mean of the red codes of a raw page.
double mean_red(const Reply& page) {
    double sum = 0;
    for (std::size_t i = 0; i < page.body.size(); i += 4) sum += static_cast<unsigned char>(page.body[i]);
    return sum / (static_cast<double>(page.body.size()) / 4);
}

std::string without_spaces(std::string text) {
    std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
    return text;
}

TEST_F(ChannelPages, TileJsonNamesTheSetsThatASceneHas) {
    EXPECT_THAT(without_spaces(client.get("/scenes/surface").value().body),
                HasSubstr(R"("channels":["albedo","normal","roughness","height","moments"])"));
    EXPECT_THAT(without_spaces(client.get("/scenes/plain").value().body),
                HasSubstr(R"("channels":["albedo"])"));
}

TEST_F(ChannelPages, EverySetHasItsOwnPageTagAndImmutableAddress) {
    const std::string fingerprint = load_scene(folder->path / "surface").value()->fingerprint;
    std::set<std::string> tags, bodies;
    for (const ChannelSet set : channel_sets) {
        const std::string name{name_of(set)};
        const std::string query = set == ChannelSet::albedo ? "" : "?channels=" + name;
        for (const std::string format : {"png", "rgba"}) {
            const std::string place = "/8/3/5." + format;
            const Reply now = client.get("/scenes/surface" + place + query).value();
            ASSERT_EQ(now.status, 200u) << now.body;
            EXPECT_EQ(now["tessera-channels"], name);
            EXPECT_EQ(now["cache-control"], "no-cache");
            EXPECT_TRUE(tags.insert(now["etag"]).second) << name;
            EXPECT_TRUE(bodies.insert(now.body).second) << name;
            EXPECT_EQ(now.body.find("sRGB") != std::string::npos,
                      format == "png" && set == ChannelSet::albedo);

            // Known pages cost nothing, and one set's tag is no other's
            const std::string known = "If-None-Match: " + now["etag"] + "\r\n";
            EXPECT_EQ(client.get("/scenes/surface" + place + query, known).value().status, 304u);
            const std::string other = set == ChannelSet::height ? "?channels=normal" : "?channels=height";
            EXPECT_EQ(client.get("/scenes/surface" + place + other, known).value().status, 200u);

            const Reply pinned = client.get("/scenes/surface/r0-" + fingerprint + place + query).value();
            EXPECT_EQ(pinned["cache-control"], "public, max-age=31536000, immutable");
            EXPECT_EQ(pinned.body, now.body);
        }
    }
}

TEST_F(ChannelPages, OneAddressNamesOnePage) {
    const std::string base =
        "/scenes/surface/r0-" + load_scene(folder->path / "surface").value()->fingerprint;
    const Reply spelled_out = client.get(base + "/8/3/5.png?channels=albedo").value();
    EXPECT_EQ(spelled_out.status, 308u);
    EXPECT_EQ(spelled_out["location"], base + "/8/3/5.png");
    const Reply disordered = client.get(base + "/8/3/5.png?channels=normal&gutter=2").value();
    EXPECT_EQ(disordered.status, 308u);
    EXPECT_EQ(disordered["location"], base + "/8/3/5.png?gutter=2&channels=normal");
}

TEST_F(ChannelPages, BumpsThatAreTooSmallToSeeBecomeRoughness) {
    const double fine = mean_red(client.get("/scenes/surface/10/3/5.rgba?channels=roughness").value());
    const double coarse = mean_red(client.get("/scenes/surface/5/3/5.rgba?channels=roughness").value());
    EXPECT_GT(fine, 60);
    EXPECT_LT(fine, 90);
    EXPECT_GT(coarse, fine + 30);
    const Reply far = client.get("/scenes/surface/5/3/5.rgba?channels=normal").value();
    EXPECT_NEAR(mean_red(far), 128, 8);
}

TEST_F(ChannelPages, WhatASceneHasNotIsRefusedWithWhatItHas) {
    const Reply absent = client.get("/scenes/plain/8/3/5.png?channels=normal").value();
    EXPECT_EQ(absent.status, 404u);
    EXPECT_EQ(absent["cache-control"], "no-store");
    EXPECT_THAT(absent.body, HasSubstr("it has albedo"));
    const Reply unknown = client.get("/scenes/surface/8/3/5.png?channels=specular").value();
    EXPECT_EQ(unknown.status, 400u);
    EXPECT_THAT(unknown.body, HasSubstr("albedo, normal, roughness, height or moments"));
}

TEST_F(ChannelPages, AreCountedBySet) {
    const auto count = [&] {
        const std::string text = client.get("/metrics").value().body;
        const std::string name = R"(tessera_page_requests_by_channels_total{channels="moments"} )";
        return std::stod(text.substr(text.find(name) + name.size()));
    };
    const double before = count();
    for (int i = 0; i < 3; ++i) client.get("/scenes/surface/9/3/5.png?channels=moments").value();
    EXPECT_EQ(count(), before + 3);
}

}  // namespace
}  // namespace tessera
