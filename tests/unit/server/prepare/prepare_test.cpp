#include "server/prepare/prepare.h"

#include <filesystem>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/prepare/perceptual.h"
#include "server/scene/image_file.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

using testing::HasSubstr;

/// Keeps what it is told; stops when a stage begins, if asked to.
class RecordingProgress final : public Progress {
  public:
    void advance(std::string_view stage, double fraction) override {
        const std::lock_guard lock{mutex_};
        EXPECT_TRUE(fraction >= 0 && fraction <= 1) << fraction;
        if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
        if (stage == stop_at) source_.request_stop();
    }
    void note(const std::string& sentence) override { notes += sentence + "\n"; }
    std::stop_token stop() const override { return source_.get_token(); }

    std::vector<std::string> stages;
    std::string notes;
    std::string stop_at;

  private:
    std::mutex mutex_;
    std::stop_source source_;
};

void expect_equal(const ExchangeAsset& a, const ExchangeAsset& b) {
    EXPECT_EQ(a.tile.bytes, b.tile.bytes);
    EXPECT_EQ(a.labels, b.labels);
    ASSERT_EQ(a.patches.size(), b.patches.size());
    for (std::size_t p = 0; p < a.patches.size(); ++p) {
        ASSERT_EQ(a.patches[p].contents.size(), b.patches[p].contents.size());
        for (std::size_t c = 0; c < a.patches[p].contents.size(); ++c) {
            EXPECT_EQ(a.patches[p].contents[c].at.x, b.patches[p].contents[c].at.x);
            EXPECT_EQ(a.patches[p].contents[c].at.y, b.patches[p].contents[c].at.y);
        }
    }
}

std::uint64_t fingerprint(const ExchangeAsset& asset) {
    std::uint64_t print = 0;
    const auto add = [&](std::int64_t value) { print = mix(print * 31 + static_cast<std::uint64_t>(value)); };
    for (const std::uint8_t byte : asset.tile.bytes) add(byte);
    for (const std::uint16_t label : asset.labels) add(label);
    for (const auto& patch : asset.patches)
        for (const auto& content : patch.contents) {
            add(content.at.x);
            add(content.at.y);
            for (const std::uint8_t byte : content.shape.bytes) add(byte);
        }
    return print;
}

constexpr PrepareOptions small{.tile_side = 64, .patches = 16, .contents = 6, .blend_texels = 4};

/// What is seen of an asset whose every patch shows each of its contents, the tile's own included, equally
/// often.
struct Measured {
    double seam =
        0;  ///< Mean distance of neighbours across shapes' borders, in parts of the photograph's mean.
    double uncut_seam = 0;  ///< The same if every content filled its patch.
    double repetition = 0;  ///< Correlation of the lightness with itself one period away.
};

Measured measure(const ExchangeAsset& asset) {
    const PerceptualImage photo = to_perceptual(asset.exemplar), tile = to_perceptual(asset.tile);
    const std::int32_t wrap = asset.tile_side - 1;
    double gradient = 0, mean = 0, square = 0, square_of_means = 0;
    for (std::int32_t y = 1; y < photo.height; ++y)
        for (std::int32_t x = 1; x < photo.width; ++x)
            gradient += color_distance(photo.at(x, y), photo.at(x - 1, y)) +
                        color_distance(photo.at(x, y), photo.at(x, y - 1));
    gradient /= 2.0 * (photo.width - 1) * (photo.height - 1);
    struct Sum {
        double distances = 0, pairs = 0;
    } cut, uncut;
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const auto& patch = asset.patches[p];
        const auto at = [&](std::int32_t x, std::int32_t y) {
            return tile.at((patch.x + x) & wrap, (patch.y + y) & wrap);
        };
        const auto holds = [&](std::int32_t x, std::int32_t y) {
            return x >= 0 && y >= 0 && x < patch.width && y < patch.height &&
                   asset.labels[static_cast<std::size_t>(((patch.y + y) & wrap) * asset.tile_side +
                                                         ((patch.x + x) & wrap))] == p;
        };
        for (std::int32_t y = 0; y < patch.height; ++y)
            for (std::int32_t x = 0; x < patch.width; ++x) {
                if (!holds(x, y)) continue;
                double sum = at(x, y).lightness, squares = sum * sum;
                for (const auto& content : patch.contents) {
                    const auto shown = [&](std::int32_t u, std::int32_t v) {
                        return holds(u, v) && content.shape.at(u, v);
                    };
                    const PerceptualColor own = photo.at(content.at.x + x, content.at.y + y);
                    const double lightness = shown(x, y) ? own.lightness : at(x, y).lightness;
                    sum += lightness;
                    squares += lightness * lightness;
                    for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
                        const auto add = [&](Sum& seam, bool is_border) {
                            seam.pairs += is_border ? 1 : 0;
                            seam.distances += is_border ? color_distance(own, at(u, v)) : 0;
                        };
                        add(cut, shown(x, y) && !shown(u, v));
                        add(uncut, !holds(u, v));
                    }
                }
                const auto count = static_cast<double>(patch.contents.size() + 1);
                mean += sum / count;
                square += squares / count;
                square_of_means += sum / count * (sum / count);
            }
    }
    const double texels = static_cast<double>(asset.labels.size());
    mean /= texels;
    return {cut.distances / cut.pairs / gradient, uncut.distances / uncut.pairs / gradient,
            (square_of_means / texels - mean * mean) / (square / texels - mean * mean)};
}

TEST(Prepare, hides_the_period_and_the_seams) {
    SilentProgress progress;
    const auto made = prepare_content_exchange(test::made_gravel(256, 256),
                                               {.tile_side = 128, .contents = 12}, nullptr, progress);
    ASSERT_TRUE(made) << made.error().detail;
    const Measured measured = measure(made->asset);
    EXPECT_LT(measured.repetition, 1.0 / 12 + 0.03);
    EXPECT_LT(measured.seam, 0.8 * measured.uncut_seam) << "without cuts " << measured.uncut_seam;
    EXPECT_LT(measured.seam, 1.75);
}

TEST(Prepare, one_thread_and_four_make_the_same_asset) {
    const Rgb8Image photo = test::made_photo(180, 150);
    SilentProgress progress;
    PrepareOptions options = small;
    options.threads = 1;
    const auto alone = prepare_content_exchange(photo, options, nullptr, progress);
    options.threads = 4;
    const auto together = prepare_content_exchange(photo, options, nullptr, progress);
    ASSERT_TRUE(alone && together);
    expect_equal(alone->asset, together->asset);
}

TEST(Prepare, every_compiler_and_build_makes_this_very_asset) {
    SilentProgress progress;
    const auto asset = prepare_content_exchange(test::made_photo(180, 150), small, nullptr, progress);
    ASSERT_TRUE(asset);
    // Changes when preparation changes, and only then: never between compilers or build types
    EXPECT_EQ(fingerprint(asset->asset), 0xb0e31066a7f82fcfu)
        << std::hex << "0x" << fingerprint(asset->asset);
}

TEST(Prepare, tells_its_stages_in_order) {
    RecordingProgress progress;
    ASSERT_TRUE(prepare_content_exchange(test::made_photo(150, 150), small, nullptr, progress));
    EXPECT_THAT(progress.stages, testing::ElementsAre("tile", "patches", "contents"));
    EXPECT_EQ(progress.notes, "");
}

TEST(Prepare, stops_in_every_stage_when_asked_to) {
    for (const char* stage : {"tile", "patches", "contents"}) {
        RecordingProgress progress;
        progress.stop_at = stage;
        const auto asset = prepare_content_exchange(test::made_photo(150, 150), small, nullptr, progress);
        ASSERT_FALSE(asset) << stage;
        EXPECT_EQ(asset.error().code, ErrorCode::cancelled);
    }
}

TEST(Prepare, takes_the_largest_tile_that_a_small_photograph_allows_and_says_so) {
    RecordingProgress progress;
    const auto asset =
        prepare_content_exchange(test::made_photo(90, 75), {.tile_side = 512}, nullptr, progress);
    ASSERT_TRUE(asset) << asset.error().detail;
    EXPECT_EQ(asset->asset.tile_side, 64);
    EXPECT_THAT(progress.notes, HasSubstr("the photograph of 90×75 is too small for a tile of 512"));
}

TEST(Prepare, manages_the_least_photograph_and_refuses_a_smaller_one) {
    RecordingProgress progress;
    const auto least =
        prepare_content_exchange(test::made_photo(20, 20), {.contents = 200}, nullptr, progress);
    ASSERT_TRUE(least) << least.error().detail;
    EXPECT_EQ(least->asset.tile_side, 16);
    for (const auto& patch : least->asset.patches) EXPECT_GE(patch.contents.size(), 1u);
    EXPECT_THAT(progress.notes, HasSubstr("fewer than 200 contents"));
    for (const std::int32_t side : {1, 19}) {
        const auto none = prepare_content_exchange(test::made_photo(side, 40), {}, nullptr, progress);
        ASSERT_FALSE(none);
        EXPECT_EQ(none.error().code, ErrorCode::invalid_input);
        EXPECT_THAT(none.error().detail, HasSubstr("too small for a tile; 20 a side are the least"));
    }
}

TEST(Prepare, a_photograph_of_one_colour_gives_a_tile_of_that_colour) {
    Rgb8Image photo{100, 100, std::vector<std::uint8_t>(3 * 100 * 100, 77)};
    SilentProgress progress;
    const auto asset = prepare_content_exchange(photo, small, nullptr, progress);
    ASSERT_TRUE(asset) << asset.error().detail;
    EXPECT_THAT(asset->asset.tile.bytes, testing::Each(77));
    EXPECT_EQ(asset->asset.patches.size(), 16u);
}

TEST(Prepare, refuses_options_out_of_range_by_name) {
    struct Row {
        PrepareOptions options;
        const char* says;
    };
    SilentProgress progress;
    const Rgb8Image photo = test::made_photo(100, 100);
    for (const Row& row : {Row{{.tile_side = 8}, "--tile is 8; from 16 to 4096"},
                           Row{{.tile_side = 8192}, "--tile is 8192; from 16 to 4096"},
                           Row{{.tile_side = 100}, "--tile is 100; a power of two"},
                           Row{{.patches = 15}, "--patches is 15; from 16 to 256"},
                           Row{{.contents = -1}, "--contents is -1; from 1 to 255"},
                           Row{{.blend_texels = 66}, "--blend is 66; from 0 to 64"},
                           Row{{.blend_texels = -2}, "--blend is -2; from 0 to 64"},
                           Row{{.blend_texels = 7}, "--blend is 7; an even number"}}) {
        const auto asset = prepare_content_exchange(photo, row.options, nullptr, progress);
        ASSERT_FALSE(asset) << row.says;
        EXPECT_EQ(asset.error().code, ErrorCode::invalid_input);
        EXPECT_THAT(asset.error().detail, HasSubstr(row.says));
    }
}

TEST(Prepare, real_photographs_or_the_made_one_give_full_assets) {
    std::vector<Rgb8Image> photos{test::made_photo(300, 300)};
    for (const char* name : {"rocky-trail.jpg", "leaf-litter.jpg", "gravel-grey.png"}) {
        const std::filesystem::path file = std::filesystem::path{TESSERA_EXEMPLARS} / name;
        if (!std::filesystem::exists(file)) {
            std::printf("[  NOTE    ] %s is absent: only made input was used\n", file.c_str());
            continue;
        }
        auto photo = read_rgb_image(file);
        ASSERT_TRUE(photo) << photo.error().detail;
        photos.push_back(std::move(*photo));
    }
    for (const Rgb8Image& photo : photos) {
        RecordingProgress progress;
        const auto asset = prepare_content_exchange(
            photo, {.tile_side = 128, .patches = 16, .contents = 10, .blend_texels = 8}, nullptr, progress);
        ASSERT_TRUE(asset) << asset.error().detail;
        EXPECT_EQ(asset->asset.exemplar.bytes, photo.bytes);
        EXPECT_EQ(progress.notes, "");
        for (const auto& patch : asset->asset.patches) {
            ASSERT_EQ(patch.contents.size(), 10u);
            for (const auto& content : patch.contents) {
                EXPECT_GE(content.at.x, 4);
                EXPECT_GE(content.at.y, 4);
                EXPECT_LE(content.at.x + patch.width + 4, photo.width);
                EXPECT_LE(content.at.y + patch.height + 4, photo.height);
            }
        }
    }
}

}  // namespace
}  // namespace tessera
