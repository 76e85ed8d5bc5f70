// The commands `page`, `bake` and `check` as a person runs them.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/synthetic_channels.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Outcome {
    int exit_code = 0;
    std::string output;  ///< stdout and stderr
};

class BakeCommands : public testing::Test {
  protected:
    BakeCommands() {
        fs::create_directory(folder_ / "board");
        write("board/scene.json", R"({"checker": {"cell_texels": 16}, "extent_log2_pages": 12})");
    }

    void write(const std::string& name, const std::string& text) { std::ofstream{folder_ / name} << text; }

    Outcome run(const std::string& arguments) {
        const fs::path log = folder_ / "log";
        const std::string command = "cd '" + folder_.string() + "' && '" TESSERA "' " + arguments + " >'" +
                                    log.string() + "' 2>&1 </dev/null";
        const int status = std::system(command.c_str());
        std::ostringstream text;
        text << std::ifstream{log}.rdbuf();
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
    }

    std::vector<float> pixels(const std::string& name, OIIO::ImageSpec& spec, int miplevel = 0) {
        const auto in = OIIO::ImageInput::open((folder_ / name).string());
        EXPECT_TRUE(in) << OIIO::geterror();
        std::vector<float> values;
        if (!in || !in->seek_subimage(0, miplevel)) return values;
        spec = in->spec();
        values.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
        EXPECT_TRUE(in->read_image(0, miplevel, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()));
        return values;
    }

    const tessera::tests::TemporaryFolder temporary_;
    const fs::path folder_ = temporary_.path;
};

TEST_F(BakeCommands, PageWritesTheSameBytesEveryTime) {
    for (const char* ending : {"png", "jpg", "webp", "rgba"}) {
        const std::string end = ending;
        ASSERT_EQ(run("page board 3 1 2 -o a." + end).exit_code, 0);
        ASSERT_EQ(run("page board 3 1 2 -o b." + end).exit_code, 0);
        std::ostringstream a, b;
        a << std::ifstream{folder_ / ("a." + end)}.rdbuf();
        b << std::ifstream{folder_ / ("b." + end)}.rdbuf();
        EXPECT_GT(a.str().size(), 50u);
        EXPECT_EQ(a.str(), b.str());
    }
    EXPECT_EQ(fs::file_size(folder_ / "a.rgba"), 256u * 256 * 4);
}

TEST_F(BakeCommands, AnErrorLimitIsKeptOrTheExitCodeSaysSo) {
    const Outcome loose = run("page board 3 1 2 --max-error 0.5 -o limited.png");
    EXPECT_EQ(loose.exit_code, 0) << loose.output;
    EXPECT_TRUE(fs::exists(folder_ / "limited.png"));
    EXPECT_EQ(run("bake board --region 0,0,64,64 --max-error 1 -o limited.exr").exit_code, 0);
    const Outcome number = run("page board 3 1 2 --max-error lots -o limited.png");
    EXPECT_EQ(number.exit_code, 1);
    EXPECT_THAT(number.output, HasSubstr("--max-error: \"lots\" is not a number of 8-bit codes"));
    const Outcome both = run("page board 3 1 2 --max-error 1 --accuracy fast -o limited.png");
    EXPECT_EQ(both.exit_code, 2);
    tessera::ExchangeAsset asset = tessera::tests::make_synthetic_asset({});
    fs::create_directory(folder_ / "ground");
    ASSERT_TRUE(tessera::write_exchange_asset(folder_ / "ground" / "asset", asset, {}));
    write("ground/scene.json", R"({"content_exchange": {"asset": "asset", "types": 64}})");
    const Outcome never = run("page ground 3 1 2 --max-error 0 -o never.png");
    EXPECT_EQ(never.exit_code, 1);
    EXPECT_THAT(never.output, HasSubstr("never.png: written, but its bound is"));
    EXPECT_TRUE(fs::exists(folder_ / "never.png"));
}

TEST_F(BakeCommands, BakeWritesTheTexelsOfTheRegion) {
    ASSERT_EQ(run("bake board --region=-16,0,5000,70 -o wide.png").exit_code, 0);
    OIIO::ImageSpec spec;
    const auto values = pixels("wide.png", spec);
    ASSERT_EQ(spec.width, 5000);
    ASSERT_EQ(spec.height, 70);
    for (int y = 0; y < 70; ++y)
        for (int x = 0; x < 5000; ++x) {
            const bool first = ((x / 16 - 1 + y / 16) & 1) == 0;
            ASSERT_EQ(values[static_cast<std::size_t>((y * 5000 + x) * spec.nchannels)], first ? 1.0F : 0.0F)
                << x << " " << y;
        }
}

TEST_F(BakeCommands, AnExrIsLinear) {
    ASSERT_EQ(run("bake board --level 5 --region 0,0,64,64 -o grey.exr").exit_code, 0);
    OIIO::ImageSpec spec;
    const auto values = pixels("grey.exr", spec);
    ASSERT_FALSE(values.empty());
    EXPECT_EQ(values[0], 0.5F);  // as a code it would be 0.735
}

TEST_F(BakeCommands, ATxHoldsEveryMipLevelAsEvaluated) {
    ASSERT_EQ(run("bake board --level 2 --region 256,512,256,256 -o board.tx").exit_code, 0);
    for (int level = 0; level <= 8; ++level) {
        OIIO::ImageSpec spec;
        const auto values = pixels("board.tx", spec, level);
        ASSERT_EQ(spec.width, 256 >> level);
        ASSERT_EQ(spec.height, 256 >> level);
        // Level 2 + level has cells of 4 >> level texels: grey once a texel covers two
        EXPECT_NEAR(values[0], level < 3 ? 1.0 : 188 / 255.0, 1e-6) << level;
    }
}

TEST_F(BakeCommands, CheckPrintsThePlanAndItsMemory) {
    const Outcome outcome = run("check board");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, HasSubstr("checker of 16 texels"));
    EXPECT_THAT(outcome.output, HasSubstr("memory:"));
}

TEST_F(BakeCommands, WriteTheChannelSetThatIsAskedFor) {
    tessera::ExchangeAsset asset = tessera::tests::make_synthetic_asset({});
    tessera::tests::add_flat_channel(asset, "normal", {128, 128, 255});
    tessera::tests::add_flat_channel(asset, "height", {40, 40, 40});
    fs::create_directory(folder_ / "surface");
    ASSERT_TRUE(tessera::write_exchange_asset(folder_ / "surface" / "asset", asset, {}));
    write("surface/scene.json", R"({"content_exchange": {"asset": "asset", "types": 64}})");

    ASSERT_EQ(run("page surface 3 1 2 --channels height -o page.png").exit_code, 0);
    ASSERT_EQ(run("bake surface --level 3 --region 0,0,64,64 --channels height -o part.png").exit_code, 0);
    ASSERT_EQ(run("bake surface --level 3 --region 0,0,64,64 --channels height -o part.exr").exit_code, 0);
    ASSERT_EQ(run("bake surface --level 3 --region 0,0,64,64 --channels height -o part.tx").exit_code, 0);
    for (const char* name : {"page.png", "part.png", "part.exr", "part.tx"}) {
        OIIO::ImageSpec spec;
        const auto values = pixels(name, spec);
        ASSERT_FALSE(values.empty()) << name;
        EXPECT_NEAR(values[0], 40 / 255.0, 1e-4) << name;  // no curve on the way to the file
    }
    std::ostringstream png;
    png << std::ifstream{folder_ / "part.png"}.rdbuf();
    EXPECT_EQ(png.str().find("sRGB"), std::string::npos);
    EXPECT_EQ(png.str().find("gAMA"), std::string::npos);

    const Outcome check = run("check surface");
    EXPECT_THAT(check.output, HasSubstr("channels: albedo, normal, height, moments"));
    const Outcome absent = run("page surface 3 1 2 --channels roughness -o none.png");
    EXPECT_EQ(absent.exit_code, 1);
    EXPECT_THAT(absent.output, HasSubstr("it has albedo, normal, height, moments"));
    EXPECT_FALSE(fs::exists(folder_ / "none.png"));
}

TEST_F(BakeCommands, WriteTheSliceThatIsAskedFor) {
    fs::create_directory(folder_ / "volume");
    tessera::StraightRgba8Image image{3, 1, {}};
    for (const int grey : {0, 102, 204})
        for (const int code : {grey, grey, grey, 255}) image.bytes.push_back(static_cast<std::uint8_t>(code));
    ASSERT_TRUE(tessera::write_rgba_png(folder_ / "volume" / "slices.png", image));
    write("volume/scene.json", R"({"extent_log2_pages": 2, "pattern": {"blocks": [
        {"name": "cells", "virtual_tile_map": {"cell_texels": 1}},
        {"name": "set", "pattern_set": {"image": "slices.png", "slices": 3}},
        {"name": "unused", "virtual_random_map": {"grid": "cells"}},
        {"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells"}}],
        "output": "shown"}})");
    for (const auto& [slice, grey] : {std::pair{"0", 0}, {"1", 102}, {"5", 204}, {"-1", 204}}) {
        ASSERT_EQ(run("page volume 0 1 2 -o page.png --slice " + std::string{slice}).exit_code, 0);
        ASSERT_EQ(run("bake volume --region 0,0,64,64 -o part.tx --slice " + std::string{slice}).exit_code,
                  0);
        for (const char* name : {"page.png", "part.tx"}) {
            OIIO::ImageSpec spec;
            const auto values = pixels(name, spec, name[1] == 'a' && name[2] == 'r' ? 3 : 0);
            ASSERT_FALSE(values.empty()) << name;
            EXPECT_NEAR(values[0], grey / 255.0, 1e-4) << name << " " << slice;
        }
    }
    const Outcome check = run("check volume");
    EXPECT_THAT(check.output, HasSubstr("slices: 0 to 2, which repeat"));
    EXPECT_THAT(check.output,
                HasSubstr("unused  virtual_random_map  -      dropped: does not reach the output"));
    EXPECT_THAT(check.output, HasSubstr("shown   reference_texture   texel"));
    EXPECT_NE(run("page volume 0 1 2 -o page.png --slice 1.5").exit_code, 0);
}

struct Refusal {
    const char* arguments;
    const char* says;
};

class BakeRefusals : public BakeCommands, public testing::WithParamInterface<Refusal> {};

TEST_P(BakeRefusals, AreOneClearLineAndLeaveNothingBehind) {
    fs::create_directory(folder_ / "typo");
    write("typo/scene.json", R"({"checker": {"cells": 3}})");
    fs::create_directory(folder_ / "empty");
    write("empty/scene.json", "{}");
    fs::create_directory(folder_ / "outside");
    write("outside/scene.json", R"({"content_exchange": {"asset": "../board"}})");
    const Outcome outcome = run(GetParam().arguments);
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, HasSubstr(GetParam().says));
    for (const auto& entry : fs::directory_iterator{folder_})
        EXPECT_TRUE(entry.is_directory() || entry.path().filename() == "log") << entry.path();
}

INSTANTIATE_TEST_SUITE_P(
    All, BakeRefusals,
    testing::Values(Refusal{"page board 13 0 0 -o a.png", "LEVEL is 0 to 12"},
                    Refusal{"page board 3 512 0 -o a.png", "0 to 511"},
                    Refusal{"page board 3 0 0 -o a.gif", ".png"},
                    Refusal{"page board 3 0 0 --channels normal -o a.png", "it has albedo"},
                    Refusal{"bake board --region 0,0,8,8 --channels shiny -o a.png", "it has albedo"},
                    Refusal{"page nowhere 0 0 0 -o a.png", "nowhere"},
                    Refusal{"page typo 0 0 0 -o a.png", "cells"},
                    Refusal{"page empty 0 0 0 -o a.png", "no texture"},
                    Refusal{"page outside 0 0 0 -o a.png", "content_exchange.asset"},
                    Refusal{"bake board --region 0,0,10 -o a.png", "X,Y,W,H"},
                    Refusal{"bake board --region 0,0,0,10 -o a.png", "--region"},
                    Refusal{"bake board --region 0,0,10,10 -o a.bmp", ".exr"},
                    Refusal{"bake board --region 0,0,100,100 -o a.tx", "2^k"},
                    Refusal{"bake board --region 64,0,128,128 -o a.tx", "multiple of its side"},
                    Refusal{"bake board --level 31 --region 0,0,1,1 -o a.png", "--level"},
                    Refusal{"bake board --region 0,0,8,8 -o nowhere/a.png", "nowhere/a.png"},
                    Refusal{"check typo", "cells"}));

}  // namespace
