// Two `tessera serve` beside each other, as a load balancer would have them: whoever answers, with however
// many threads and after whatever restart, the bytes are the same.
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "server/scene/asset_file.h"
#include "tests/end_to_end/server/program.h"
#include "tests/end_to_end/server/raw_client.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using test::Program;
using test::RawClient;

constexpr std::array formats{"png", "jpg", "webp", "rgba"};

struct Page {
    unsigned level, x, y;
};
/// Two for each level where there are two, of which one on an edge of the texture.
constexpr std::array pages{Page{0, 700'001, 12'345}, Page{0, 1'048'575, 0}, Page{1, 345'678, 501},
                           Page{1, 0, 524'287},      Page{3, 99'999, 77},   Page{3, 131'071, 131'071},
                           Page{6, 12'000, 5'001},   Page{6, 0, 0},         Page{9, 1'999, 3},
                           Page{9, 2'047, 1'024},    Page{20, 0, 0}};

/// In addresses the coarsest level is zoom 0.
std::string path_of(const Page& page) {
    return std::to_string(20 - page.level) + "/" + std::to_string(page.x) + "/" + std::to_string(page.y);
}

class Processes : public testing::Test {
  protected:
    void SetUp() override {
        const std::filesystem::path scene = folder.path / "noise";
        std::filesystem::create_directories(scene);
        ASSERT_TRUE(write_exchange_asset(scene / "asset", tests::make_synthetic_asset({}), {}));
        std::ofstream{scene / "scene.json"} << R"({"content_exchange": {"asset": "asset"}})";
    }
    std::unique_ptr<Program> serve(const std::string& threads) const {
        return std::make_unique<Program>(std::vector<std::string>{
            "serve", "--scenes", folder.path.string(), "--listen", "127.0.0.1:0", "--threads", threads});
    }
    /// Every page in every format: its entity tag and its bytes. All are asked for at once, so that as many
    /// threads as there are work side by side.
    static std::map<std::string, std::string> answers_of(Program& program) {
        std::map<std::string, std::string> answers;
        const std::uint16_t port = program.port();
        std::vector<RawClient> clients;
        for (const Page& page : pages) {
            RawClient& client = clients.emplace_back(port);
            for (const std::string format : formats)
                client.send("GET /scenes/noise/" + path_of(page) + "." + format +
                            "?accuracy=exact HTTP/1.1\r\nHost: test\r\n\r\n");
        }
        for (std::size_t i = 0; i < pages.size(); ++i)
            for (const std::string format : formats) {
                const auto reply = clients[i].receive();
                if (!reply || reply->status != 200) {
                    ADD_FAILURE() << path_of(pages[i]) << "." << format << ": "
                                  << (reply ? reply->body : "no answer") << program.errors();
                    return {};
                }
                answers[path_of(pages[i]) + "." + format] = (*reply)["etag"] + "\n" + reply->body;
            }
        program.signal(SIGTERM);
        EXPECT_EQ(program.exit_code(), 0);
        return answers;
    }
    static void expect_equal(const std::map<std::string, std::string>& these,
                             const std::map<std::string, std::string>& those, const std::string& who) {
        ASSERT_EQ(these.size(), those.size());
        for (const auto& [page, answer] : these) EXPECT_TRUE(answer == those.at(page)) << page << ", " << who;
    }
    const tests::TemporaryFolder folder;
};

TEST_F(Processes, AnswerEqualBytesWithOneThreadWithEightAndAfterARestart) {
    const auto one = serve("1"), eight = serve("8");
    const auto by_one = answers_of(*one);
    ASSERT_EQ(by_one.size(), pages.size() * formats.size());
    expect_equal(by_one, answers_of(*eight), "eight threads");
    expect_equal(by_one, answers_of(*serve("8")), "a restart");
    // Were the pages of one colour, everything above would hold for a broken texture too
    EXPECT_NE(by_one.at(path_of(pages[0]) + ".rgba"), by_one.at(path_of(pages[1]) + ".rgba"));

    std::vector<std::unique_ptr<Program>> commands;
    const auto file_of = [&](std::size_t i) { return folder.path / (std::to_string(i) + ".png"); };
    for (std::size_t i = 0; i < pages.size(); i += 2)
        commands.push_back(std::make_unique<Program>(std::vector<std::string>{
            "page", (folder.path / "noise").string(), std::to_string(pages[i].level),
            std::to_string(pages[i].x), std::to_string(pages[i].y), "-o", file_of(i).string()}));
    for (std::size_t i = 0; i < pages.size(); i += 2) {
        EXPECT_EQ(commands[i / 2]->exit_code(), 0) << commands[i / 2]->errors();
        std::ifstream in{file_of(i), std::ios::binary};
        const std::string bytes{std::istreambuf_iterator<char>{in}, {}};
        const std::string& served = by_one.at(path_of(pages[i]) + ".png");
        EXPECT_TRUE(bytes == served.substr(served.find('\n') + 1)) << path_of(pages[i]) << ", tessera page";
    }
}

}  // namespace
}  // namespace tessera
