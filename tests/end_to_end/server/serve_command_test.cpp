// `tessera serve` as a program: what it prints, how it refuses, how it takes signals.
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/end_to_end/server/program.h"
#include "tests/end_to_end/server/raw_client.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using test::Program;
using test::RawClient;

class ServeCommand : public testing::Test {
  protected:
    void SetUp() override {
        fs::remove_all(folder);
        scene("board", R"({"checker": {"cell_texels": 37}})");
        scene("grey", R"({"title": "Grey", "constant": {"color": {"red": 90}}})");
    }
    void TearDown() override { fs::remove_all(folder); }
    void scene(const std::string& id, const std::string& json) const {
        fs::create_directories(folder / id);
        std::ofstream{folder / id / "scene.json"} << json;
    }
    Program serve(const std::string& listen = "127.0.0.1:0") const {
        return Program{{"serve", "--scenes", folder.string(), "--listen", listen}};
    }
    static std::uint16_t port_in(const std::string& line) {
        return static_cast<std::uint16_t>(std::atoi(line.c_str() + line.rfind(':') + 1));
    }
    /// Loading these takes seconds: each reads a large file, one and the same with no blocks on the disk.
    void slow_scenes() const {
        const fs::path large = folder.string() + "_large";
        std::ofstream{large};
        fs::resize_file(large, 256 << 20);
        for (int i = 0; i < 60; ++i) {
            scene("slow" + std::to_string(i), R"({"constant": {"color": {"red": 9}}})");
            fs::create_hard_link(large, folder / ("slow" + std::to_string(i)) / "padding");
        }
        fs::remove(large);
    }
    fs::path folder = fs::temp_directory_path() / ("tessera_serve_" + std::to_string(getpid()));
};

TEST_F(ServeCommand, PrintsOneLineServesAndStopsWhenTold) {
    for (const int signal : {SIGTERM, SIGINT}) {
        Program program = serve();
        const std::string line = program.line();
        ASSERT_TRUE(line.starts_with("tessera: listening on http://127.0.0.1:")) << line << program.errors();
        EXPECT_EQ(RawClient{port_in(line)}.get("/scenes/board/3/1/2.png")->status, 200);
        program.signal(signal);
        EXPECT_EQ(program.exit_code(), 0);
        EXPECT_EQ(program.output(), line);
    }
}

TEST_F(ServeCommand, LeavesOutABrokenSceneAndSaysWhy) {
    scene("torn", R"({"title": "x", "constnat": {}})");
    Program program = serve();
    const std::string line = program.line();
    ASSERT_FALSE(line.empty()) << program.errors();
    EXPECT_TRUE(program.says("scene torn is left out: torn/scene.json: constnat"));
    RawClient client{port_in(line)};
    const auto list = client.get("/scenes").value();
    EXPECT_NE(list.body.find("torn/scene.json: constnat"), std::string::npos) << list.body;
    EXPECT_EQ(list.body.find(folder.string()), std::string::npos)
        << "the server's own paths are nobody's business";
    EXPECT_EQ(client.get("/scenes/grey/0/0/0.png").value().status, 200);
    EXPECT_EQ(client.get("/scenes/torn/0/0/0.png")->status, 404);
}

TEST_F(ServeCommand, ReloadsOnHangUpAndKeepsTheScenesIfThatFails) {
    Program program = serve();
    const std::string line = program.line();
    ASSERT_FALSE(line.empty()) << program.errors();
    RawClient client{port_in(line)};
    EXPECT_EQ(client.get("/scenes/later")->status, 404);
    scene("later", R"({"constant": {"color": {"blue": 3}}})");
    program.signal(SIGHUP);
    ASSERT_TRUE(program.says("reloaded: 3 scenes")) << program.errors();
    EXPECT_EQ(client.get("/scenes/later")->status, 200);

    fs::rename(folder, folder.string() + "_away");
    program.signal(SIGHUP);
    EXPECT_TRUE(program.says("the scenes stay as they were")) << program.errors();
    fs::rename(folder.string() + "_away", folder);
    EXPECT_EQ(client.get("/scenes/board/2/1/1.png")->status, 200);
    program.signal(SIGTERM);
    EXPECT_EQ(program.exit_code(), 0);
}

TEST_F(ServeCommand, StopsInTheMiddleOfTheFirstLoad) {
    slow_scenes();
    const Program::Clock::time_point begin = Program::Clock::now();
    Program program = serve();
    ASSERT_TRUE(program.waits_for(SIGTERM));
    program.signal(SIGTERM);
    EXPECT_EQ(program.exit_code(), 0);
    EXPECT_EQ(program.output(), "");
    // Only a load that came to its end tells of its scenes
    EXPECT_EQ(program.errors().find("scene slow0"), std::string::npos) << program.errors();
    EXPECT_LT(Program::Clock::now() - begin, std::chrono::seconds{8});
}

TEST_F(ServeCommand, StopsInTheMiddleOfReloadsThatWereAskedForTwice) {
    Program program = serve();
    const std::uint16_t port = program.port();
    slow_scenes();
    program.signal(SIGHUP);
    ASSERT_TRUE(program.says("reloading the scenes"));
    program.signal(SIGHUP);
    EXPECT_EQ(RawClient{port}.get("/scenes/grey/0/0/0.png").value().status, 200);
    program.signal(SIGTERM);
    EXPECT_EQ(program.exit_code(), 0);
    EXPECT_EQ(program.errors().find("scene slow0"), std::string::npos) << program.errors();
}

TEST_F(ServeCommand, NamesFilesInsideTheFolderOnlyWhereverItIsStarted) {
    scene("torn", R"({"title": "x", "constnat": {}})");
    fs::create_directories(folder / "elsewhere" / "far");
    fs::rename(folder / "torn", folder / "elsewhere" / "far" / "torn");
    fs::create_directory_symlink(folder / "elsewhere" / "far" / "torn", folder / "linked");
    scene("hollow", R"({"content_exchange": {"asset": "asset"}})");
    Program program{{"serve", "--scenes", folder.filename().string(), "--listen", "127.0.0.1:0"},
                    folder.parent_path().string()};
    const std::string list = RawClient{program.port()}.get("/scenes").value().body;
    EXPECT_NE(list.find("\"linked/scene.json: constnat"), std::string::npos) << list;
    EXPECT_NE(list.find("\"hollow/scene.json: content_exchange.asset: hollow/asset"), std::string::npos)
        << list;
    EXPECT_EQ(list.find(folder.parent_path().string() + "/"), std::string::npos) << list;
}

TEST_F(ServeCommand, GoesOnWithItsScenesWhenAReloadRunsOutOfMemory) {
#ifdef TESSERA_SANITIZED
    GTEST_SKIP() << "NOT TESTED under sanitizers: their shadow memory leaves no room for a limit";
#endif
    const fs::path web = folder / "web";
    fs::create_directories(web);
    std::ofstream{web / "index.html"} << "<!doctype html>";
    Program program{{"serve", "--scenes", folder.string(), "--web", web.string(), "--listen", "127.0.0.1:0"}};
    RawClient client{program.port()};
    std::ofstream{web / "large.bin"};
    fs::resize_file(web / "large.bin", 60 << 20);
    ASSERT_TRUE(program.limit_memory(32 << 20));
    program.signal(SIGHUP);
    EXPECT_TRUE(program.says("the scenes stay as they were: there is not enough memory")) << program.errors();
    EXPECT_EQ(client.get("/scenes/grey/0/0/0.png").value().status, 200);
    fs::remove(web / "large.bin");
    program.signal(SIGHUP);
    EXPECT_TRUE(program.says("reloaded: 2 scenes")) << program.errors();
    program.signal(SIGTERM);
    EXPECT_EQ(program.exit_code(), 0);
}

TEST_F(ServeCommand, RefusesInOneLineWhatCannotWork) {
    Program first = serve();
    const std::string taken = "127.0.0.1:" + std::to_string(port_in(first.line()));
    const fs::path empty = folder / "empty";
    fs::create_directories(empty);
    struct Case {
        std::vector<std::string> arguments;
        std::string message;
    };
    for (const Case& wrong :
         {Case{{"--scenes", folder.string(), "--listen", taken}, "choose another port"},
          Case{{"--scenes", (folder / "none").string(), "--listen", "127.0.0.1:0"}, "--scenes"},
          Case{{"--scenes", empty.string(), "--listen", "127.0.0.1:0"}, "holds no scene"},
          Case{{"--scenes", folder.string(), "--listen", "localhost"}, "ADDRESS:PORT"},
          Case{{"--scenes", folder.string(), "--listen", "127.0.0.1:70000"}, "ADDRESS:PORT"},
          Case{{"--scenes", folder.string(), "--listen", "nowhere:1"}, "numeric"},
          Case{{"--scenes", folder.string(), "--listen", "127.0.0.1:0", "--web", empty.string()},
               "index.html"}}) {
        std::vector<std::string> arguments{"serve"};
        arguments.insert(arguments.end(), wrong.arguments.begin(), wrong.arguments.end());
        Program program{arguments};
        EXPECT_EQ(program.exit_code(), 1) << wrong.message;
        EXPECT_EQ(program.output(), "");
        EXPECT_NE(program.errors().find(wrong.message), std::string::npos) << program.errors();
        EXPECT_EQ(std::count(program.errors().begin(), program.errors().end(), '\n'), 1) << program.errors();
    }
}

}  // namespace
}  // namespace tessera
