// Photographs that cannot be prepared: each is refused with its file's name and a fix, and nothing is left
// behind.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include "tests/end_to_end/prepare/prepare_runs.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class BadPhotographs : public PrepareRuns {
  protected:
    void write_foreign(const std::string& name, int width, int height, int channels, OIIO::TypeDesc type,
                       const void* samples) {
        OIIO::ImageSpec spec{width, height, channels, type};
        if (channels == 2) spec.alpha_channel = 1;
        spec.attribute("oiio:UnassociatedAlpha", 1);
        auto out = OIIO::ImageOutput::create((folder_ / name).string());
        ASSERT_TRUE(out) << OIIO::geterror();
        ASSERT_TRUE(out->open((folder_ / name).string(), spec)) << out->geterror();
        ASSERT_TRUE(out->write_image(type, samples)) << out->geterror();
        ASSERT_TRUE(out->close());
    }

    void expect_refused(const std::string& photo, const std::string& says, const std::string& options = {}) {
        const std::size_t before = entries();
        const Outcome outcome = run("prepare " + photo + " -o asset" + options);
        EXPECT_EQ(outcome.exit_code, 1) << photo;
        EXPECT_THAT(outcome.output, HasSubstr(photo + ": ")) << options;
        EXPECT_THAT(outcome.output, HasSubstr(says)) << options;
        EXPECT_EQ(entries(), before) << photo << " left something behind";
    }

    void expect_prepared(const std::string& photo) {
        const Outcome outcome = run("prepare " + photo + " -o asset --tile 32 --patches 16 --contents 3 -q");
        EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
        EXPECT_TRUE(fs::exists(folder_ / "asset" / "asset.json"));
    }
};

TEST_F(BadPhotographs, TooSmallOnes) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 4000}, {19, 300}, {17, 17}}) {
        const std::string name = std::to_string(width) + "x" + std::to_string(height) + ".png";
        write_photo(name, width, height);
        expect_refused(name,
                       "is " + std::to_string(width) + "×" + std::to_string(height) + " texels, too small");
    }
}

TEST_F(BadPhotographs, NoneOfTheseIsBad) {
    write_photo("wide.png", 190, 70);
    expect_prepared("wide.png");
    const Rgb8Image photo = test::made_photo(90, 80);
    std::vector<std::uint16_t> deep;
    std::vector<std::uint8_t> grey, rgba;
    for (std::size_t i = 0; i < photo.bytes.size(); ++i)
        deep.push_back(static_cast<std::uint16_t>(257 * photo.bytes[i]));
    for (std::size_t i = 0; i < photo.bytes.size(); i += 3) {
        grey.push_back(photo.bytes[i]);
        rgba.insert(rgba.end(), {photo.bytes[i], photo.bytes[i + 1], photo.bytes[i + 2], 255});
    }
    write_foreign("deep.tif", 90, 80, 3, OIIO::TypeDesc::UINT16, deep.data());
    write_foreign("grey.png", 90, 80, 1, OIIO::TypeDesc::UINT8, grey.data());
    write_foreign("opaque.png", 90, 80, 4, OIIO::TypeDesc::UINT8, rgba.data());
    for (const char* name : {"deep.tif", "grey.png", "opaque.png"}) expect_prepared(name);
}

TEST_F(BadPhotographs, TransparentTruncatedAndLargeOnes) {
    const Rgb8Image photo = test::made_photo(90, 80);
    std::vector<std::uint8_t> rgba;
    for (std::size_t i = 0; i < photo.bytes.size(); i += 3)
        rgba.insert(rgba.end(), {photo.bytes[i], photo.bytes[i + 1], photo.bytes[i + 2],
                                 std::uint8_t(i == 300 ? 90 : 255)});
    write_foreign("clear.png", 90, 80, 4, OIIO::TypeDesc::UINT8, rgba.data());
    expect_refused("clear.png", "transparent texels; fill them with a background");

    write_photo("whole.png", 90, 80);
    const std::string bytes = text_of(folder_ / "whole.png");
    std::ofstream{folder_ / "cut.png", std::ios::binary} << bytes.substr(0, bytes.size() * 3 / 4);
    expect_refused("cut.png", "broken or truncated png");
    std::ofstream{folder_ / "notes.jpg"} << "not a picture";
    expect_refused("notes.jpg", "is no PNG, JPEG, WebP or TIFF by its first bytes");

    write_photo("large.png", 1100, 1000);
    expect_refused("large.png",
                   "is 1100×1000 texels, more than the limit of 32768 a side and 1048576 in all; scale it "
                   "down, or allow more with --max-megapixels",
                   " --max-megapixels 1");
}

TEST_F(BadPhotographs, AFolderThatIsNoAssetIsKept) {
    write_photo("photo.png", 90, 80);
    fs::create_directory(folder_ / "asset");
    std::ofstream{folder_ / "asset" / "letter.txt"} << "dear";
    const Outcome outcome = run("prepare photo.png -o asset");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("holds letter.txt, which is no part of an asset"));
    EXPECT_EQ(text_of(folder_ / "asset" / "letter.txt"), "dear");
}

}  // namespace
}  // namespace tessera
