#include "server/http/load_site.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

TEST(LoadSite, StripsTheFolderOnlyWhereAPathBegins) {
    EXPECT_EQ(without_folder("/srv/s/torn/scene.json: title: is odd", "/srv/s"),
              "torn/scene.json: title: is odd");
    EXPECT_EQ(without_folder("/srv/s/a/b: run `prepare -o /srv/s/a/b`", "/srv/s"),
              "a/b: run `prepare -o a/b`");
    EXPECT_EQ(without_folder("a/srv/s/b: is not /srv/scenes/c", "/srv/s"), "a/srv/s/b: is not /srv/scenes/c");
    EXPECT_EQ(without_folder("/torn/scene.json: a/b", "/"), "torn/scene.json: a/b");
    EXPECT_EQ(without_folder("/srv/far/scene.json: x", "/srv/far", "near"), "near/scene.json: x");
    EXPECT_EQ(without_folder("/srv/far: x", "/srv/far", "near"), "near: x");
    EXPECT_EQ(without_folder("/srv/far: x", "/srv/far"), "far: x");
}

TEST(LoadSite, SaysWhatIsWrongAndEndsWhenToldTo) {
    const tests::TemporaryFolder folder;
    ServerOptions options;
    options.scenes = folder.path / "none";
    EXPECT_EQ(load_site(options, {}).error().code, ErrorCode::io_failure);
    options.scenes = folder.path;
    EXPECT_EQ(load_site(options, {}).error().code, ErrorCode::invalid_input);
    std::filesystem::create_directories(folder.path / "grey");
    std::ofstream{folder.path / "grey" / "scene.json"} << R"({"constant": {"color": {"red": 90}}})";
    EXPECT_EQ(load_site(options, {})->catalog->scenes.size(), 1u);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(load_site(options, stop.get_token()).error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace tessera
