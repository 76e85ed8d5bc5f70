#include <filesystem>
#include <fstream>
#include <memory>

#include <google/protobuf/struct.pb.h>
#include <gtest/gtest.h>

#include "shared/wire/json.h"
#include "tests/end_to_end/load/child_process.h"
#include "tests/end_to_end/server/raw_client.h"
#include "tests/support/temporary_folder.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using Fields = google::protobuf::Map<std::string, google::protobuf::Value>;

/// `tessera serve` with one scene, a checker.
class Load : public testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directories(folder_ / "scenes" / "checker");
        std::ofstream{folder_ / "scenes" / "checker" / "scene.json"}
            << R"({"title": "A checker", "extent_log2_pages": 12, "checker": {"cell_texels": 40}})";
        server_ = std::make_unique<ChildProcess>(
            TESSERA_PROGRAM, std::vector<std::string>{"serve", "--scenes", (folder_ / "scenes").string(),
                                                      "--listen", "127.0.0.1:0"});
        const std::string line = server_->read_line(60s);
        const std::string announcement = "tessera: listening on ";
        ASSERT_EQ(line.substr(0, announcement.size()), announcement);
        url_ = line.substr(announcement.size());
    }
    void TearDown() override { server_.reset(); }

    ChildProcess start(std::vector<std::string> arguments, const std::string& scene = "checker") const {
        arguments.insert(arguments.begin(), {url_, scene, "--quiet", "--json", "-"});
        return {TESSERA_LOAD_PROGRAM, std::move(arguments)};
    }

    /// Runs to its end and reads its result, which is empty if there is none.
    Fields run(std::vector<std::string> arguments, int expected_exit) const {
        ChildProcess load = start(std::move(arguments));
        return result_of(load, expected_exit);
    }

    static Fields result_of(ChildProcess& load, int expected_exit) {
        const std::string text = load.read_all(60s);
        EXPECT_EQ(load.wait(60s), expected_exit) << text;
        google::protobuf::Struct document;
        const auto read = read_json(text, "the result", document);
        EXPECT_TRUE(read) << read.error().detail;
        return document.fields();
    }

    static double number(const Fields& fields, const std::string& group, const std::string& name) {
        const auto found = fields.find(group);
        if (found == fields.end()) return -1;
        const auto& inner = found->second.struct_value().fields();
        const auto value = inner.find(name);
        return value == inner.end() ? -1 : value->second.number_value();
    }

    const tests::TemporaryFolder temporary_;
    const std::filesystem::path& folder_ = temporary_.path;
    std::unique_ptr<ChildProcess> server_;
    std::string url_;
};

TEST_F(Load, OfARealServerInAClosedLoopFindsEveryPageWholeAndTheSameEachTime) {
    const Fields result =
        run({"--duration", "1", "--warmup", "0.2", "--working-set", "40", "--verify", "--assert", "errors==0",
             "--assert", "mismatches==0", "--assert", "changed==0"},
            0);
    EXPECT_GT(number(result, "requests", "pages"), 50);
    EXPECT_GT(number(result, "verify", "compared"), 10);
    EXPECT_GT(number(result, "cache_results", "hit"), 0) << "the server says where a page came from";
}

TEST_F(Load, KeepsToItsRateOnEveryWalkAndFormat) {
    for (const std::string walk : {"random", "sweep", "camera"}) {
        const Fields result = run({"--walk", walk, "--rate", "100", "--duration", "0.5", "--warmup", "0",
                                   "--format", "rgba", "--gutter", "4", "--zstd", "--assert", "errors==0"},
                                  0);
        EXPECT_EQ(number(result, "requests", "planned"), 50) << walk;
        EXPECT_EQ(number(result, "requests", "pages"), 50) << walk;
    }
}

TEST_F(Load, ReplaysTheCameraPathsOfTheViewer) {
    const auto path = (folder_ / "path.json").string();
    std::ofstream{path} << R"({"keys": [{"time": 0, "x": 4000, "y": 4000, "height": 600, "pitch": -60},
                                        {"time": 2, "x": 9000, "y": 5000, "height": 6000, "pitch": -60}]})";
    const Fields result =
        run({"--walk", "camera", "--camera", path, "--duration", "0.5", "--warmup", "0"}, 0);
    EXPECT_GT(number(result, "levels", "1"), 0);
    std::ofstream{path} << R"({"keys": []})";
    ChildProcess broken = start({"--walk", "camera", "--camera", path});
    EXPECT_EQ(broken.wait(60s), 2);
}

TEST_F(Load, FailsItsAssertionsWithThree) {
    run({"--duration", "0.2", "--warmup", "0", "--assert", "p99<=1ns"}, 3);
}

TEST_F(Load, SaysThatThereIsNoSuchSceneAndThatNobodyListens) {
    EXPECT_EQ(start({}, "chequer").wait(60s), 1);
    server_.reset();
    EXPECT_EQ(start({}).wait(60s), 1);
}

TEST_F(Load, GivesTheFiguresSoFarWhenItIsInterrupted) {
    ChildProcess load = start({"--duration", "60", "--warmup", "0", "--rate", "200"});
    const auto answered = [&]() -> double {
        const std::string port = url_.substr(url_.rfind(':') + 1);
        const auto metrics = RawClient{static_cast<std::uint16_t>(std::stoi(port))}.get("/metrics");
        const std::string name = "tessera_http_answers_total{status=\"200\"} ";
        const std::size_t at = metrics ? metrics->body.find(name) : std::string::npos;
        return at == std::string::npos ? 0 : std::stod(metrics->body.substr(at + name.size()));
    };
    for (int i = 0; i < 1000 && answered() < 100; ++i) std::this_thread::sleep_for(20ms);
    load.signal(SIGINT);
    const Fields result = result_of(load, 130);
    EXPECT_GT(number(result, "requests", "pages"), 20);
    const auto interrupted = result.find("interrupted");
    ASSERT_NE(interrupted, result.end());
    EXPECT_TRUE(interrupted->second.bool_value());
}

}  // namespace
}  // namespace tessera::test
