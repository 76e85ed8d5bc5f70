#include "client/load/load_options.h"

#include <vector>

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace std::chrono_literals;

CommandLine read(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "tessera-load");
    return read_command_line(static_cast<int>(arguments.size()), arguments.data());
}

TEST(LoadOptions, ReadsACommandLine) {
    const CommandLine line = read({"http://127.0.0.1:7070",
                                   "pebbles",
                                   "--walk",
                                   "sweep",
                                   "--rate",
                                   "250.5",
                                   "--duration",
                                   "2min",
                                   "--warmup",
                                   "500ms",
                                   "--connections",
                                   "64",
                                   "--format",
                                   "rgba",
                                   "--gutter",
                                   "4",
                                   "--zstd",
                                   "--assert",
                                   "p99<=5ms",
                                   "--assert",
                                   "errors==0",
                                   "--json",
                                   "-"});
    ASSERT_TRUE(line.go_on);
    const LoadOptions& options = line.options;
    EXPECT_EQ(options.server, (ServerAddress{"127.0.0.1", 7070}));
    EXPECT_EQ(options.scene, "pebbles");
    EXPECT_EQ(options.walk, "sweep");
    EXPECT_EQ(options.plan.rate, 250.5);
    EXPECT_EQ(options.plan.duration, 2min);
    EXPECT_EQ(options.plan.warmup, 500ms);
    EXPECT_EQ(options.plan.connections, 64u);
    EXPECT_EQ(options.plan.options, (FetchOptions{PageFormat::rgba, 4, Accuracy::high}));
    EXPECT_TRUE(options.plan.accept_zstd);
    EXPECT_EQ(options.assertions.size(), 2u);
    EXPECT_EQ(options.json_file, "-");
}

TEST(LoadOptions, RefusesWrongCommandLinesWithTwo) {
    for (const std::vector<const char*>& arguments :
         std::vector<std::vector<const char*>>{{},
                                               {"http://h"},
                                               {"https://h", "s"},
                                               {"http://h", "s", "--walk", "moon"},
                                               {"http://h", "s", "--rate", "-1"},
                                               {"http://h", "s", "--rate", "nan"},
                                               {"http://h", "s", "--duration", "0"},
                                               {"http://h", "s", "--duration", "5 parsecs"},
                                               {"http://h", "s", "--connections", "0"},
                                               {"http://h", "s", "--gutter", "17"},
                                               {"http://h", "s", "--assert", "p99"},
                                               {"http://h", "s", "--camera", "path.json"},
                                               {"http://h", "s", "--zstd"},
                                               {"http://h", "s", "--unknown"}}) {
        testing::internal::CaptureStderr();
        const CommandLine line = read(arguments);
        const std::string said = testing::internal::GetCapturedStderr();
        EXPECT_FALSE(line.go_on) << ::testing::PrintToString(arguments);
        EXPECT_EQ(line.exit_code, 2) << ::testing::PrintToString(arguments);
        EXPECT_FALSE(said.empty());
    }
}

TEST(LoadOptions, ExplainsItselfWithExamples) {
    testing::internal::CaptureStdout();
    const CommandLine line = read({"--help"});
    const std::string help = testing::internal::GetCapturedStdout();
    EXPECT_FALSE(line.go_on);
    EXPECT_EQ(line.exit_code, 0);
    for (const char* word : {"Examples:", "--assert", "--rate", "Exit codes", "pages_per_s"})
        EXPECT_NE(help.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace tessera
