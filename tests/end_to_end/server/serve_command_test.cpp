// `tessera serve` as a program: what it prints, how it refuses, how it takes signals.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include "tests/end_to_end/server/raw_client.h"

extern char** environ;

namespace tessera {
namespace {

namespace fs = std::filesystem;
using test::RawClient;

/// The program with these arguments; stdout and stderr are read through pipes.
class Program {
  public:
    explicit Program(std::vector<std::string> arguments) {
        int out[2], err[2];
        EXPECT_EQ(pipe2(out, O_CLOEXEC), 0);
        EXPECT_EQ(pipe2(err, O_CLOEXEC), 0);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, out[1], 1);
        posix_spawn_file_actions_adddup2(&actions, err[1], 2);
        arguments.insert(arguments.begin(), TESSERA_PROGRAM);
        std::vector<char*> words;
        for (std::string& argument : arguments) words.push_back(argument.data());
        words.push_back(nullptr);
        EXPECT_EQ(posix_spawn(&pid_, TESSERA_PROGRAM, &actions, nullptr, words.data(), environ), 0);
        posix_spawn_file_actions_destroy(&actions);
        ::close(out[1]);
        ::close(err[1]);
        out_ = out[0];
        err_ = err[0];
    }
    ~Program() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
        ::close(out_);
        ::close(err_);
    }

    /// The line that says the server is ready; empty if it never does.
    std::string line() { return read_until(out_, out_text_, "\n"); }
    bool says(const std::string& text) { return read_until(err_, err_text_, text).size() > 0; }
    const std::string& errors() const { return err_text_; }

    void signal(int number) const { ::kill(pid_, number); }
    int exit_code() {
        read_until(err_, err_text_, "\x01");  // to its end
        read_until(out_, out_text_, "\x01");
        int status = 0;
        ::waitpid(std::exchange(pid_, -1), &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    }
    const std::string& output() const { return out_text_; }

  private:
    static std::string read_until(int file, std::string& text, const std::string& mark) {
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds{10};
        for (;;) {
            if (const std::size_t at = text.find(mark); at != std::string::npos)
                return text.substr(0, at + mark.size());
            pollfd ready{file, POLLIN, 0};
            if (std::chrono::steady_clock::now() > until || ::poll(&ready, 1, 10'000) <= 0) return {};
            char block[4096];
            const ssize_t count = ::read(file, block, sizeof block);
            if (count <= 0) return {};
            text.append(block, static_cast<std::size_t>(count));
        }
    }

    pid_t pid_ = -1;
    int out_ = -1, err_ = -1;
    std::string out_text_, err_text_;
};

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
    EXPECT_EQ(client.get("/scenes/grey/0/0/0.png")->status, 200);
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
