#include "server/http/web_files.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

class WebFilesTest : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder / "assets"); }
    void TearDown() override { fs::remove_all(folder); }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream{folder / name, std::ios::binary} << text;
    }
    fs::path folder = fs::temp_directory_path() / ("tessera_web_" + std::to_string(getpid()));
};

TEST_F(WebFilesTest, AreReadWithTheirTypes) {
    write("index.html", "<!doctype html>");
    write("assets/app-3f2a9c1b.js", std::string(2000, 'x'));
    write("assets/application.js", "1");
    const auto files = WebFiles::read(folder).value();
    EXPECT_EQ(files->find(""), files->find("index.html"));
    EXPECT_EQ(files->find("index.html")->content_type, "text/html; charset=utf-8");
    const WebFiles::File* app = files->find("assets/app-3f2a9c1b.js");
    ASSERT_NE(app, nullptr);
    EXPECT_TRUE(app->immutable);
    EXPECT_LT(app->gzip.size(), app->bytes.size());
    EXPECT_FALSE(files->find("assets/application.js")->immutable);
    EXPECT_EQ(files->find("../index.html"), nullptr);
    EXPECT_EQ(files->find("assets"), nullptr);
}

TEST_F(WebFilesTest, AFolderWithoutAPageSaysWhatToDo) {
    EXPECT_NE(WebFiles::read(folder).error().detail.find("index.html"), std::string::npos);
    EXPECT_EQ(WebFiles::read(folder / "none").error().code, ErrorCode::io_failure);
}

TEST(PlainPage, SaysHowToBuildTheRealOne) {
    const auto* page = WebFiles::plain()->find("");
    ASSERT_NE(page, nullptr);
    EXPECT_NE(std::string(page->bytes.begin(), page->bytes.end()).find("npm run build"), std::string::npos);
}

}  // namespace
}  // namespace tessera
