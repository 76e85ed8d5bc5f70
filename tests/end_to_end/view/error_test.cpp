#include <fstream>

#include <gmock/gmock.h>

#include "tests/end_to_end/view/scene_server.h"

namespace tessera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace tessera::testing;

const std::string nobody = "http://127.0.0.1:9";  // the discard port: nothing listens there

TEST(ViewErrors, AServerThatIsNotThereIsNamed) {
    const auto ended = run_view({nobody, "pebbles", "--headless", "-o", "nowhere"});
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.error, AllOf(HasSubstr("tessera-view: "), HasSubstr("127.0.0.1:9")));
}

TEST(ViewErrors, AnUnknownSceneIsAnsweredWithThoseThereAre) {
    const SceneServer server;
    const auto ended = run_view({server.url(), "bord", "--headless", "-o", "nowhere"});
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.error, AllOf(HasSubstr("bord"), HasSubstr("board"), HasSubstr("grey")));

    const auto window = run_view({server.url(), "board"});
    EXPECT_EQ(window.exit_code, 1) << "no display here";
    EXPECT_THAT(window.error, HasSubstr("--headless"));

    const auto stepped = run_view({server.url(), "board", "--headless", "-o", "nowhere", "--step", "7"});
    EXPECT_EQ(stepped.exit_code, 1);
    EXPECT_THAT(stepped.error, HasSubstr("--step: nothing moves in scene board"));

    const auto path = server.folder() / "path.json";
    std::ofstream{path} << R"({"keys": [{"x": "99999999999", "height": 3}]})";
    const auto outside =
        run_view({server.url(), "board", "--headless", "-o", "nowhere", "--camera", path.string()});
    EXPECT_EQ(outside.exit_code, 1);
    EXPECT_THAT(outside.error, AllOf(HasSubstr("path.json"), HasSubstr("keys[0]"), HasSubstr("x and y")));
}

TEST(ViewErrors, ATextureFolderThatIsNoneIsNamedBeforeAnythingIsDrawn) {
    const auto ended =
        run_view({"--headless", "--compare-filters", "--textures", "no-such-folder", "-o", "nowhere"});
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.error, AllOf(HasSubstr("--textures"), HasSubstr("no-such-folder")));
}

TEST(ViewErrors, AWrongCommandLineSaysWhatIsWrong) {
    const auto wrong = [](const std::vector<std::string>& arguments) {
        const auto ended = run_view(arguments);
        EXPECT_EQ(ended.exit_code, 2) << ended.error;
        return ended.out + ended.error;
    };
    EXPECT_THAT(wrong({nobody}), HasSubstr("SCENE"));
    EXPECT_THAT(wrong({nobody, "board", "--headless"}), HasSubstr("-o FOLDER"));
    EXPECT_THAT(wrong({nobody, "board", "--size", "800"}), HasSubstr("WIDTHxHEIGHT"));
    EXPECT_THAT(wrong({nobody, "board", "--size", "9x9"}), HasSubstr("16 to 8192"));
    EXPECT_THAT(wrong({nobody, "board", "--frames", "0"}), HasSubstr("--frames"));
    EXPECT_THAT(wrong({nobody, "board", "--step", "7"}), HasSubstr("--step is for --headless"));
    EXPECT_THAT(wrong({nobody, "board", "--cache-pages", "3"}), HasSubstr("--cache-pages"));
    for (const char* number : {"--relief", "--split-at", "--panel-scale", "--record-limit"})
        EXPECT_THAT(wrong({nobody, "board", number, "nan"}), HasSubstr(number));
}

TEST(ViewErrors, HelpExplainsKeysPathsAndTheRunWithoutADisplay) {
    const auto ended = run_view({"--help"});
    EXPECT_EQ(ended.exit_code, 0);
    EXPECT_THAT(ended.out, AllOf(HasSubstr("W A S D"), HasSubstr("\"keys\""), HasSubstr("no X server")));
}

}  // namespace
}  // namespace tessera
