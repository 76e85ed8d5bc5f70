#include <fstream>
#include <set>

#include <gmock/gmock.h>

#include "client/view/view.pb.h"
#include "shared/wire/json.h"
#include "tests/end_to_end/view/scene_server.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using namespace tessera::testing;

/// The hash of one frame that the program draws with these options.
std::string hash_of_frame(const SceneServer& server, const std::vector<std::string>& options) {
    const fs::path out = server.folder() / "views";
    std::vector<std::string> arguments{VIEW_PROGRAM, server.url(), "board", "--headless",
                                       "--size",     "200x160",    "-o",    out.string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    Program program{arguments};
    const Program::Ended ended = program.end();
    EXPECT_EQ(ended.exit_code, 0) << ended.error;
    std::ifstream stream{out / "metrics.json", std::ios::binary};
    const std::string json{std::istreambuf_iterator<char>{stream}, {}};
    view::RunMetrics metrics;
    if (const auto read = read_json(json, "metrics.json", metrics); !read || metrics.frames_size() != 1) {
        ADD_FAILURE() << "no frame";
        return {};
    }
    return metrics.frames(0).hash();
}

TEST(ViewViews, DrawEachSurfaceOverlayAndSplitWithoutADisplayAndTheSameTwice) {
    const SceneServer server;
    const std::vector<std::vector<std::string>> looks{
        {},
        {"--view", "terrain"},
        {"--view", "corridor"},
        {"--view", "terrain", "--relief", "0.5"},
        {"--view", "terrain", "--overlay", "level"},
        {"--view", "corridor", "--split", "line-integral", "--split-at", "0.3"},
    };
    std::set<std::string> hashes;
    for (const auto& look : looks) hashes.insert(hash_of_frame(server, look));
    EXPECT_EQ(hashes.size(), looks.size());
    EXPECT_TRUE(hashes.contains(hash_of_frame(server, looks[1])));
    EXPECT_FALSE(hash_of_frame(server, {"--split", "fast"}).empty()) << "a second connection";
}

TEST(ViewViews, ShowASplitCorridorInAWindowWithLargePanels) {
    const SceneServer server;
    const fs::path out = server.folder() / "window";
    Program program{{XVFB_RUN,     "-a",         "-s",       "-screen 0 1280x1024x24",
                     VIEW_PROGRAM, server.url(), "board",    "--size",
                     "640x480",    "--view",     "corridor", "--split",
                     "exact",      "--overlay",  "age",      "--panel-scale",
                     "2",          "--frames",   "5",        "-o",
                     out.string()}};
    const Program::Ended ended = program.end();
    EXPECT_EQ(ended.exit_code, 0) << ended.error;
    EXPECT_TRUE(fs::exists(out / "window.png")) << ended.error;
}

TEST(ViewViews, RefuseHeightsForAPlane) {
    Program program{{VIEW_PROGRAM, "http://127.0.0.1:1", "board", "--terrain", "hills.png"}};
    const Program::Ended ended = program.end();
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_THAT(ended.error, HasSubstr("--view terrain"));
}

}  // namespace
}  // namespace tessera
