#include "client/link/page_body.h"

#include <gtest/gtest.h>
#include <zstd.h>

namespace tessera {
namespace {

std::string packed(const std::string& content) {
    std::string result(ZSTD_compressBound(content.size()), '\0');
    result.resize(ZSTD_compress(result.data(), result.size(), content.data(), content.size(), 1));
    return result;
}

TEST(PageBody, UnpacksZstd) {
    const std::string content(300'000, 'x');
    EXPECT_EQ(decode_body(packed(content), "zstd", 300'000).value(), content);
}

TEST(PageBody, LeavesPlainBodiesAlone) { EXPECT_EQ(decode_body("abc", "", 3).value(), "abc"); }

TEST(PageBody, RefusesMoreThanTheLimitWhateverTheFrameSays) {
    EXPECT_EQ(decode_body(packed(std::string(1 << 24, 'x')), "zstd", 1000).error().code,
              ErrorCode::io_failure);
    EXPECT_EQ(decode_body("abcd", "", 3).error().code, ErrorCode::io_failure);
    // A frame of unstated size, as streaming encoders write it
    ZSTD_CCtx* encoder = ZSTD_createCCtx();
    ZSTD_CCtx_setParameter(encoder, ZSTD_c_contentSizeFlag, 0);
    const std::string content(1 << 20, 'x');
    std::string frame(ZSTD_compressBound(content.size()), '\0');
    frame.resize(ZSTD_compress2(encoder, frame.data(), frame.size(), content.data(), content.size()));
    ZSTD_freeCCtx(encoder);
    EXPECT_EQ(decode_body(frame, "zstd", content.size()).value(), content);
    EXPECT_EQ(decode_body(frame, "zstd", content.size() - 1).error().code, ErrorCode::io_failure);
}

TEST(PageBody, RefusesDamagedAndTruncatedAndUnknownEncodings) {
    const std::string good = packed(std::string(1000, 'y'));
    EXPECT_FALSE(decode_body(good.substr(0, good.size() - 3), "zstd", 1000));
    EXPECT_FALSE(decode_body("not zstd at all", "zstd", 1000));
    EXPECT_FALSE(decode_body("", "zstd", 1000));
    EXPECT_FALSE(decode_body(good, "br", 1000));
}

}  // namespace
}  // namespace tessera
