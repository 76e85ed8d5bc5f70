// `tessera accuracy` as a person runs it: a report that is whole or not there, and words for what is wrong.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include "proto/accuracy.pb.h"

#include "server/scene/image_file.h"
#include "shared/wire/json.h"
#include "tests/support/temporary_folder.h"

extern char** environ;

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
    int exit_code = 0;
    std::string output;
};

std::string text_of(const fs::path& file) {
    std::ifstream in{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

class AccuracyCommand : public testing::Test {
  protected:
    AccuracyCommand() {
        Rgb8Image photo;
        photo.width = 80;
        photo.height = 60;
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 80; ++x)
                for (const int code : {3 * x, 4 * y, (x * y) % 256})
                    photo.bytes.push_back(static_cast<std::uint8_t>(code));
        EXPECT_TRUE(write_rgb_png(folder_ / "photo.png", photo));
        fs::create_directory(folder_ / "board");
        std::ofstream{folder_ / "board/scene.json"} << R"({"checker": {"cell_texels": 16}})";
    }

    Outcome run(const std::string& arguments) {
        const std::string command = "cd '" + folder_.string() + "' && '" TESSERA "' accuracy " + arguments +
                                    " >'" + log_.string() + "' 2>&1 </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(log_)};
    }

    /// Hidden ones too: what was not finished would be one of these.
    std::size_t entries() const { return std::size_t(std::distance(fs::directory_iterator{folder_}, {})); }

    proto::AccuracyReport report(const std::string& folder) {
        proto::AccuracyReport read;
        const auto done = read_json(text_of(folder_ / folder / "report.json"), "report.json", read);
        EXPECT_TRUE(done) << done.error().detail;
        return read;
    }

    const tests::TemporaryFolder temporary_, elsewhere_;
    const fs::path folder_ = temporary_.path;
    const fs::path log_ = elsewhere_.path / "log";
};

TEST_F(AccuracyCommand, WritesAReportThatStandsByItself) {
    const Outcome outcome = run("checker photo.png board -o report/ --quick --width 32 --no-pages");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("claims hold"));
    const proto::AccuracyReport found = report("report");
    std::set<std::string> textures, situations, filters;
    for (const proto::AccuracyRow& row : found.rows()) {
        textures.insert(row.texture());
        situations.insert(row.situation());
        filters.insert(row.filter());
        EXPECT_GT(row.nanoseconds_per_sample(), 0) << row.filter();
        EXPECT_GT(row.texels_per_sample(), 0) << row.filter();
        EXPECT_GT(row.pixels(), 0u);
        EXPECT_EQ(row.truth_mse() == 0, row.texture() == "checker") << row.filter();
        for (const std::string& picture : {row.picture(), row.error_picture(), row.count_picture()})
            if (!picture.empty()) {
                EXPECT_TRUE(fs::exists(folder_ / "report" / picture)) << picture;
            }
        if (row.texture() == "checker" && row.filter() == "exact") {
            EXPECT_LT(row.mse(), 0.01);
        }
    }
    EXPECT_THAT(textures, testing::ElementsAre("board", "checker", "photo"));
    EXPECT_EQ(situations.size(), 3u);
    EXPECT_GT(filters.size(), 20u);
    EXPECT_GT(found.claims_size(), 5);
    EXPECT_THAT(text_of(folder_ / "report/report.csv"),
                HasSubstr("\"checker-horizon\",\"photo\",\"exact\",\"cpu\""));
    EXPECT_TRUE(fs::exists(folder_ / "report/plot.png"));

    // The page asks nobody for anything
    const std::string page = text_of(folder_ / "report/index.html");
    EXPECT_THAT(page, HasSubstr("line-integral"));
    for (const char* foreign : {"http://", "https://", " src=\"//", "@import"}) {
        std::string rest = page;
        if (const auto svg = rest.find("http://www.w3.org/2000/svg"); svg != std::string::npos)
            rest.erase(svg, 26);
        EXPECT_THAT(rest, Not(HasSubstr(foreign)));
    }
    EXPECT_THAT(page, Not(HasSubstr("/*REPORT*/")));
    // Nothing but the report is left
    EXPECT_EQ(entries(), 3u);

    // A second run takes the place of the first
    ASSERT_EQ(run("board -o report --quick --width 32 --no-pages --no-pictures -q").exit_code, 0);
    EXPECT_EQ(text_of(log_), "");
    EXPECT_FALSE(fs::exists(folder_ / "report/pictures/corridor-checker-truth.png"));
    EXPECT_EQ(entries(), 3u);
}

TEST_F(AccuracyCommand, RefusesByNameAndLeavesNothing) {
    std::ofstream{folder_ / "words.png"} << "no image at all";
    fs::create_directory(folder_ / "broken");
    std::ofstream{folder_ / "broken/scene.json"} << R"({"checker": {"cell_texel": 16}})";
    fs::create_directory(folder_ / "mine");
    std::ofstream{folder_ / "mine/letter.txt"} << "keep me";
    std::ofstream{folder_ / "gpu.json"} << R"({"rows": [{"situation": "corridor"}]})";
    const std::size_t before = entries();
    const auto refused = [&](const std::string& arguments, const std::string& names,
                             const std::string& says) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 1) << arguments;
        EXPECT_THAT(outcome.output, HasSubstr(names)) << arguments;
        EXPECT_THAT(outcome.output, HasSubstr(says)) << arguments;
        EXPECT_EQ(entries(), before) << arguments;
    };
    refused("missing.png -o report", "missing.png: ", "no such file");
    refused("words.png -o report", "words.png: ", "");
    refused("broken -o report", "scene.json: ", "cell_texel");
    refused("photo.png -o mine", "mine: ", "no accuracy report");
    refused("photo.png -o photo.png", "photo.png: ", "is no folder");
    refused("photo.png", "-o FOLDER", "");
    refused("photo.png -o report --gpu-rows gpu.json", "gpu.json: rows[0]: ", "has no texture");
    refused("photo.png -o report --gpu-rows none.json", "none.json", "");
    EXPECT_EQ(text_of(folder_ / "mine/letter.txt"), "keep me");
}

TEST_F(AccuracyCommand, ABombIsRefusedBeforeItIsDecoded) {
    // A PNG header that promises 30,000 × 30,000 pixels
    std::string png = text_of(folder_ / "photo.png");
    for (const std::size_t at : {std::size_t{16}, std::size_t{20}})
        png.replace(at, 4, std::string{"\0\0\x75\x30", 4});
    std::ofstream{folder_ / "bomb.png", std::ios::binary} << png;
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome = run("bomb.png -o report");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("bomb.png: "));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{5});
}

TEST_F(AccuracyCommand, ExportsWhatAGpuClientMeasuresOn) {
    ASSERT_EQ(run("--export-textures out -q").exit_code, 0);
    for (const auto& [name, side] : {std::pair{"photograph", 1024}, {"checker", 512}, {"text", 1024}}) {
        const auto image = read_rgb_image(folder_ / "out" / (std::string{name} + ".png"));
        ASSERT_TRUE(image) << name;
        EXPECT_EQ(image->width, side);
        EXPECT_EQ(image->height, side);
    }
}

TEST_F(AccuracyCommand, TakesInTheRowsOfAGpu) {
    std::ofstream{folder_ / "gpu.json"} << R"({"rows": [
        {"situation": "corridor", "texture": "checker", "filter": "anisotropic-16", "where": "a renderer",
         "mse": 15, "ms_ssim": 0.98, "frame_milliseconds": 10, "texels_per_sample": 45},
        {"situation": "corridor", "texture": "checker", "filter": "trilinear", "where": "a renderer",
         "mse": 400, "ms_ssim": 0.7, "frame_milliseconds": 30, "texels_per_sample": 8}]})";
    const Outcome outcome =
        run("checker -o report --quick --width 32 --no-pages --no-pictures -q --gpu-rows gpu.json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    int seen = 0;
    const proto::AccuracyReport told = report("report");
    for (const proto::AccuracyRow& row : told.rows())
        if (row.where() == "a renderer") {
            ++seen;
            EXPECT_EQ(row.pareto(), row.filter() == "anisotropic-16");
        }
    EXPECT_EQ(seen, 2);
}

TEST_F(AccuracyCommand, LeavesNothingWhenItIsStopped) {
    const std::size_t before = entries();
    const std::string report = (folder_ / "report").string();
    std::vector<std::string> words{TESSERA, "accuracy", "checker", "-o", report, "--thorough", "-q"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t child = -1;
    ASSERT_EQ(posix_spawn(&child, TESSERA, nullptr, nullptr, arguments.data(), environ), 0);
    for (int i = 0; i < 500 && !fs::exists(report + ".partial/pictures"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    ASSERT_TRUE(fs::exists(report + ".partial/pictures"));
    std::this_thread::sleep_for(std::chrono::milliseconds{300});
    ASSERT_EQ(::kill(child, SIGINT), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 128 + SIGINT);
    EXPECT_EQ(entries(), before);
}

}  // namespace
}  // namespace tessera
