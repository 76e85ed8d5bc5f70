#include "client/view/compare_filters.h"

#include <fstream>

#include <OpenImageIO/imagebuf.h>
#include <gmock/gmock.h>

#include "client/render/gl_context.h"
#include "client/view/compare_report.h"
#include "client/view/options.h"
#include "client/view/png_file.h"
#include "client/view/viewer_state.h"
#include "shared/math/hash.h"
#include "shared/wire/json.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using ::testing::HasSubstr;
using tests::TemporaryFolder;

/// Grey stones of many sizes, more or less.
CompareTexture rubble() {
    CompareTexture texture{"rubble", {128, 128}, {}};
    for (std::int32_t y = 0; y < 128; ++y)
        for (std::int32_t x = 0; x < 128; ++x) {
            double code = 0;
            for (int shift = 0; shift < 6; ++shift)
                code += static_cast<double>(hash(4, stream("rubble", static_cast<std::uint64_t>(shift)),
                                                 x >> shift, y >> shift) %
                                            256) /
                        6;
            std::uint8_t* texel = texture.image.row(y) + 4 * x;
            std::fill_n(texel, 3, static_cast<std::uint8_t>(code));
            texel[3] = 255;
        }
    return texture;
}

TEST(CompareFilters, FindsLineIntegralsFourTimesBetterThan16xInEverySituation) {
    const auto context = make_headless_context();
    ASSERT_TRUE(context) << context.error().detail;
    const TemporaryFolder folder;
    std::size_t steps = 0;
    const CompareJob job{.textures = {rubble()},
                         .width = 160,
                         .height = 140,
                         .folder = folder.path / "new" / "folder",
                         .rounds = 1,
                         .command = "made"};
    const auto report = compare_filters(job, [&](const std::string&) { ++steps; });
    ASSERT_TRUE(report) << report.error().detail;
    std::cout << table_of(*report);
    EXPECT_EQ(report->rows_size(), 3 * static_cast<int>(compared_filters().size()));
    EXPECT_GE(steps, compared_filters().size());
    EXPECT_EQ(report->claims_size(), 6);
    for (const auto& claim : report->claims())
        EXPECT_TRUE(claim.holds()) << claim.text() << ": " << claim.figures();
    for (const auto& row : report->rows()) {
        EXPECT_TRUE(std::filesystem::exists(job.folder / row.picture())) << row.picture();
        EXPECT_TRUE(std::filesystem::exists(job.folder / row.error_picture()));
        EXPECT_GT(row.frame_milliseconds(), 0);
        EXPECT_LE(row.frame_milliseconds_best(), row.frame_milliseconds());
        EXPECT_FALSE(row.where().empty());
        if (row.filter() == "trilinear") {
            EXPECT_EQ(row.texels_per_sample(), 8);
        }
        if (row.filter() == "supersample-8x8") {
            EXPECT_EQ(row.texels_per_sample(), 512);
        }
    }
    EXPECT_TRUE(std::filesystem::exists(job.folder / "sheet_corridor_rubble.png"));

    std::ifstream file{job.folder / "report.json"};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    proto::AccuracyReport read;
    ASSERT_TRUE(read_json(text, "report.json", read));
    EXPECT_EQ(read.rows_size(), report->rows_size());
}

/// The middle of each photograph, or what is made instead of them where there are none.
std::vector<CompareTexture> photographs() {
    std::vector<CompareTexture> all;
    if (std::filesystem::exists(EXEMPLARS))
        for (const auto& file : std::filesystem::directory_iterator{EXEMPLARS}) {
            const std::string extension = file.path().extension().string();
            if ((extension != ".jpg" && extension != ".png") ||
                file.path().stem().string().ends_with("-height"))
                continue;
            OIIO::ImageBuf image{file.path().string()};
            const int side = std::min({512, image.spec().width, image.spec().height});
            if (side < 512 || image.nchannels() < 3) continue;
            CompareTexture texture{file.path().stem().string(), {512, 512}, {}};
            std::vector<std::uint8_t> codes(std::size_t{3} * 512 * 512);
            const int left = (image.spec().width - 512) / 2, top = (image.spec().height - 512) / 2;
            image.get_pixels(OIIO::ROI{left, left + 512, top, top + 512, 0, 1, 0, 3}, OIIO::TypeDesc::UINT8,
                             codes.data());
            for (std::int32_t y = 0; y < 512; ++y)
                for (std::int32_t x = 0; x < 512; ++x) {
                    std::uint8_t* texel = texture.image.row(y) + 4 * x;
                    std::copy_n(&codes[static_cast<std::size_t>(y * 512 + x) * 3], 3, texel);
                    texel[3] = 255;
                }
            all.push_back(std::move(texture));
        }
    if (all.empty()) all.push_back(rubble());
    return all;
}

TEST(CompareFilters, FindsLineIntegralsFourTimesBetterThan16xOnEveryPhotograph) {
    const auto context = make_headless_context();
    ASSERT_TRUE(context) << context.error().detail;
    const TemporaryFolder folder;
    const CompareJob job{.textures = photographs(),
                         .width = 160,
                         .height = 140,
                         .folder = folder.path,
                         .rounds = 1,
                         .command = "photographs"};
    const auto report = compare_filters(job, [](const std::string&) {});
    ASSERT_TRUE(report) << report.error().detail;
    EXPECT_EQ(report->claims_size(), 6 * static_cast<int>(job.textures.size()));
    for (const auto& claim : report->claims()) {
        std::cout << claim.text() << ": " << claim.figures() << '\n';
        EXPECT_TRUE(claim.holds()) << claim.text() << ": " << claim.figures();
    }
}

TEST(CompareTextures, AreRefusedByNameWithWhatToDo) {
    const TemporaryFolder folder;
    const auto problem = [&] {
        const auto read = read_textures(folder.path);
        return read ? std::string{"read"} : read.error().detail;
    };
    EXPECT_THAT(read_textures(folder.path / "missing").error().detail,
                AllOf(HasSubstr("--textures"), HasSubstr("missing"), HasSubstr("no folder")));
    EXPECT_THAT(problem(), HasSubstr("holds no PNG image"));
    std::ofstream{folder.path / "words.png"} << "these are words";
    EXPECT_THAT(problem(), AllOf(HasSubstr("words.png"), HasSubstr("no PNG image")));
    std::filesystem::remove(folder.path / "words.png");

    ASSERT_TRUE(write_png(folder.path / "line.png", Rgba8Image{40, 1}));
    EXPECT_THAT(problem(), AllOf(HasSubstr("line.png"), HasSubstr("40×1"), HasSubstr("2 to 8192")));
    std::filesystem::remove(folder.path / "line.png");

    ASSERT_TRUE(write_png(folder.path / "odd.png", Rgba8Image{100, 70}));
    std::filesystem::resize_file(folder.path / "odd.png",
                                 std::filesystem::file_size(folder.path / "odd.png") / 2);
    EXPECT_THAT(problem(), HasSubstr("odd.png"));
    ASSERT_TRUE(write_png(folder.path / "odd.png", Rgba8Image{100, 70}));
    const auto read = read_textures(folder.path);
    ASSERT_TRUE(read) << read.error().detail;
    ASSERT_EQ(read->size(), 1u);
    EXPECT_EQ(read->front().name, "odd");
    EXPECT_EQ(read->front().image.width, 64);
    EXPECT_THAT(read->front().cropped, HasSubstr("64×64 of 100×70"));
}

int exit_code_of(std::vector<const char*> arguments, Options& options) {
    arguments.insert(arguments.begin(), "tessera-view");
    int exit_code = 0;
    ::testing::internal::CaptureStderr();
    const bool read = read_options(static_cast<int>(arguments.size()), arguments.data(), options, exit_code);
    ::testing::internal::GetCapturedStderr();
    return read ? 0 : exit_code;
}

TEST(Options, OfACompareNeedNoServerAndRefuseWhatDoesNotFit) {
    Options options;
    EXPECT_EQ(
        exit_code_of({"--headless", "--compare-filters", "-o", "out", "--width", "64", "--height", "48"},
                     options),
        0);
    EXPECT_TRUE(options.compare_filters);
    EXPECT_EQ(options.width, 64);
    EXPECT_EQ(options.height, 48);
    for (const std::vector<const char*>& wrong :
         {std::vector<const char*>{"--compare-filters", "-o", "out"},
          {"--headless", "--compare-filters"},
          {"http://a:1", "b", "--headless", "--compare-filters", "-o", "out"},
          {"http://a:1", "b", "--textures", "folder"},
          {"http://a:1", "b", "--filter", "sharpest"},
          {"http://a:1", "b", "--columns", "1"},
          {"--headless", "--compare-filters", "-o", "out", "--width", "3"},
          {"--headless", "-o", "out"}}) {
        Options refused;
        EXPECT_EQ(exit_code_of(wrong, refused), 2) << wrong.front() << " … " << wrong.back();
    }
    Options chosen;
    EXPECT_EQ(exit_code_of({"http://a:1", "b", "--filter", "line-integral", "--columns", "12"}, chosen), 0);
    EXPECT_EQ(chosen.filter.filter, Filter::line_integral);
    EXPECT_EQ(chosen.filter.columns, 12);
}

TEST(FilterSwitch, GoesRoundAllFiltersBothWaysAndPastWhatTheDriverHasNot) {
    Filter filter = Filter::trilinear;
    for (std::size_t i = 0; i < filters.size(); ++i) filter = filter_after(filter, 1, true);
    EXPECT_EQ(filter, Filter::trilinear);
    EXPECT_EQ(filter_after(filter_after(filter, 1, true), -1, true), Filter::trilinear);
    for (const Filter from : filters) EXPECT_NE(filter_after(from, 1, false), Filter::driver_anisotropic);
    EXPECT_EQ(filter_after(Filter::supersample, 1, true), Filter::nearest);
}

}  // namespace
}  // namespace tessera
