#include "server/prepare/prepare.h"

#include <filesystem>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
        }
    return print;
}

constexpr PrepareOptions small{.tile_side = 64, .patches = 16, .contents = 6, .blend_texels = 4};

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
    EXPECT_EQ(fingerprint(asset->asset), 0x77b29973f63baf6au)
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
