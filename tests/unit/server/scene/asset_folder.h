#pragma once

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "proto/asset.pb.h"

#include "server/scene/asset_file.h"
#include "shared/math/hash.h"
#include "tests/support/temporary_folder.h"

namespace tessera {

namespace fs = std::filesystem;

inline BitMask full(std::int32_t width, std::int32_t height) {
    BitMask mask{width, height};
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) mask.set(x, y);
    return mask;
}

inline ExchangeAsset::Content content(ExchangeAsset::Offset at, BitMask shape) {
    return {at, std::move(shape), ExchangeAsset::Standing::chosen, 0};
}

/// A tile of 16 in sixteen patches of 4×4, the first of which starts at (14, 14) and wraps.
inline ExchangeAsset small_asset() {
    ExchangeAsset asset;
    asset.exemplar = {30, 24, {}};
    for (int i = 0; i < 3 * 30 * 24; ++i)
        asset.exemplar.bytes.push_back(static_cast<std::uint8_t>(hash(1, 1, i, 0)));
    asset.tile = {16, 16, {}};
    for (int i = 0; i < 3 * 16 * 16; ++i)
        asset.tile.bytes.push_back(static_cast<std::uint8_t>(hash(1, 2, i, 0)));
    asset.tile_side = 16;
    asset.blend_texels = 4;
    asset.labels.resize(16 * 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            asset.labels[static_cast<std::size_t>(y * 16 + x)] =
                static_cast<std::uint16_t>((y + 2) % 16 / 4 * 4 + (x + 2) % 16 / 4);
    for (int p = 0; p < 16; ++p)
        asset.patches.push_back({(p % 4 * 4 + 14) % 16,
                                 (p / 4 * 4 + 14) % 16,
                                 4,
                                 4,
                                 {content({2, 2}, full(4, 4)), content({24, 18}, full(4, 4)),
                                  content({std::max(2, p), 9}, full(4, 4))}});
    return asset;
}

/// Patches of 9×5 and 8×8 on a tile of 16, one in each set, which do not meet, and one over the tile's
/// corner.
inline ExchangeAsset small_interchange() {
    ExchangeAsset asset = small_asset();
    asset.method = ExchangeMethod::interchange;
    asset.labels.clear();
    asset.patches = {{4, 5, 9, 5, {content({3, 4}, {})}, ExchangeAsset::Set::a},
                     {-2, 4, 4, 8, {content({10, 9}, {})}, ExchangeAsset::Set::b},
                     {13, -3, 8, 8, {content({12, 12}, {})}, ExchangeAsset::Set::none}};
    for (auto& patch : asset.patches) {
        patch.contents[0].shape = BitMask{patch.width, patch.height};
        for (std::int32_t i = 0; i < patch.height; ++i) patch.contents[0].shape.set(i % patch.width, i);
    }
    return asset;
}

inline std::string text_of(const fs::path& file) {
    std::ifstream in{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

/// An asset in a folder, which tests change.
class AssetFile : public testing::Test {
  protected:
    tests::TemporaryFolder folder;
    fs::path asset = folder.path / "asset";
    fs::path json = asset / "asset.json";

    void SetUp() override { ASSERT_TRUE(write_exchange_asset(asset, small_asset(), {})); }

    void change(const std::function<void(proto::ExchangeAsset&)>& edit) {
        proto::ExchangeAsset message;
        ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(text_of(json), &message).ok());
        edit(message);
        std::string text;
        ASSERT_TRUE(google::protobuf::util::MessageToJsonString(message, &text).ok());
        std::ofstream{json} << text;
    }

    void expect_refused(const fs::path& file, const std::string& says) {
        const auto read = read_exchange_asset(asset);
        ASSERT_FALSE(read) << says;
        EXPECT_THAT(read.error().detail, testing::HasSubstr(file.string() + ": "));
        EXPECT_THAT(read.error().detail, testing::HasSubstr(says));
    }
};

}  // namespace tessera
