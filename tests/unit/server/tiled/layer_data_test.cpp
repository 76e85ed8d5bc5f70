#include "server/tiled/layer_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/tiled/layer_text.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::vector<std::uint32_t> tiles{0, 1, 255, 256, 0x80000001u, 0xffffffffu, 7};

struct Coding {
    const char* encoding;
    const char* compression;
};
constexpr Coding codings[] = {
    {"csv", ""}, {"base64", ""}, {"base64", "zlib"}, {"base64", "gzip"}, {"base64", "zstd"}};

TEST(LayerData, ReadsTheSameTilesFromEveryCoding) {
    for (const auto& [encoding, compression] : codings)
        for (std::size_t count = 0; count <= tiles.size(); ++count) {
            const std::vector<std::uint32_t> some{tiles.begin(), tiles.begin() + std::ptrdiff_t(count)};
            const auto read =
                decode_layer(test::layer_text(some, encoding, compression), encoding, compression, count);
            ASSERT_TRUE(read) << encoding << compression << count << read.error().detail;
            EXPECT_EQ(*read, some) << encoding << " " << compression;
        }
}

TEST(LayerData, RefusesAnotherNumberOfTiles) {
    for (const auto& [encoding, compression] : codings)
        for (const std::size_t count : {tiles.size() - 1, tiles.size() + 1, std::size_t{1} << 24}) {
            const auto read =
                decode_layer(test::layer_text(tiles, encoding, compression), encoding, compression, count);
            EXPECT_FALSE(read) << encoding << " " << compression << " " << count;
        }
}

TEST(LayerData, RefusesWhatIsDamagedAndNeverReadsBeyondIt) {
    for (const auto& [encoding, compression] : codings) {
        const std::string whole = test::layer_text(tiles, encoding, compression);
        for (std::size_t cut = 0; cut + 6 < whole.size(); ++cut)
            EXPECT_FALSE(
                decode_layer(std::string_view{whole}.substr(0, cut), encoding, compression, tiles.size()))
                << encoding << " " << compression << " " << cut;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            std::string broken = whole;
            broken[i] = static_cast<char>(broken[i] ^ 21);
            const auto read = decode_layer(broken, encoding, compression, tiles.size());
            EXPECT_TRUE(!read || read->size() == tiles.size());
        }
    }
}

TEST(LayerData, SaysWhatIsWrong) {
    const auto why = [](std::string_view text, const char* encoding, const char* compression) {
        return decode_layer(text, encoding, compression, 2).error().detail;
    };
    EXPECT_THAT(why("1,x", "csv", ""), HasSubstr("no number"));
    EXPECT_THAT(why("1 2", "csv", ""), HasSubstr("no comma"));
    EXPECT_THAT(why("1,4294967296", "csv", ""), HasSubstr("no number"));
    EXPECT_THAT(why("AQAAAA==", "base64", ""), HasSubstr("holds 4 bytes for 2 cells"));
    EXPECT_THAT(why("AQ!AAA==", "base64", ""), HasSubstr("no base64"));
    EXPECT_THAT(why("AQAAAA==", "base64", "lzma"), HasSubstr("zlib, gzip or zstd"));
    EXPECT_THAT(why("", "hex", ""), HasSubstr("csv or base64"));
}

TEST(LayerData, ABombIsNotUnpacked) {
    // 64 MiB of nothing, which are claimed to be two cells; and two cells that are claimed to be 64 MiB
    const std::string nothing(std::size_t{1} << 26, '\0');
    for (const char* compression : {"zlib", "gzip", "zstd"}) {
        const std::string bomb = test::to_base64(test::packed(nothing, compression));
        EXPECT_FALSE(decode_layer(bomb, "base64", compression, 2)) << compression;
        const std::string small = test::to_base64(test::packed(std::string(8, '\0'), compression));
        EXPECT_THAT(decode_layer(small, "base64", compression, std::size_t{1} << 24).error().detail,
                    HasSubstr("is too short"));
    }
}

}  // namespace
}  // namespace tessera
