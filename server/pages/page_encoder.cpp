#include "server/pages/page_encoder.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

#include <turbojpeg.h>
#include <webp/encode.h>
#include <zstd.h>

#include "server/pages/png_encoder.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr int jpeg_quality = 90;
constexpr int webp_lossless_level = 0;  // level 3 takes twelve times as long for 7 to 10 % fewer bytes
constexpr int zstd_level = 1;

Error codec_failure(std::string_view codec, const std::string& why) {
    return {ErrorCode::io_failure, std::string{codec} + ": " + why};
}

Result<EncodedBytes> encode_jpeg(const Rgba8Image& image) {
    struct Release {
        void operator()(void* codec) const noexcept { tjDestroy(codec); }
    };
    thread_local const std::unique_ptr<void, Release> codec{tjInitCompress()};
    if (!codec) return codec_failure("jpg", tjGetErrorStr2(nullptr));
    EncodedBytes out(tjBufSize(image.width, image.height, TJSAMP_444));
    unsigned char* begin = out.data();
    unsigned long size = out.size();
    // The accurate DCT is integer-exact, with and without SIMD. Premultiplied codes are the page over black.
    const int failed =
        tjCompress2(codec.get(), image.bytes.data(), image.width, 0, image.height, TJPF_RGBX, &begin, &size,
                    TJSAMP_444, jpeg_quality, TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC);
    if (failed != 0) return codec_failure("jpg", tjGetErrorStr2(codec.get()));
    out.resize(size);
    return out;
}

Result<EncodedBytes> encode_webp(const Rgba8Image& premultiplied) {
    const Rgba8Image image = to_straight_alpha(premultiplied);
    WebPConfig config;
    WebPPicture picture;
    if (WebPConfigInit(&config) == 0 || WebPConfigLosslessPreset(&config, webp_lossless_level) == 0 ||
        WebPPictureInit(&picture) == 0)
        return codec_failure("webp", "the library is not the version it was built with");
    const std::unique_ptr<WebPPicture, decltype(&WebPPictureFree)> release_picture{&picture, WebPPictureFree};
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    const std::unique_ptr<WebPMemoryWriter, decltype(&WebPMemoryWriterClear)> release_writer{
        &writer, WebPMemoryWriterClear};
    picture.use_argb = 1;
    picture.width = image.width;
    picture.height = image.height;
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    if (WebPPictureImportRGBA(&picture, image.bytes.data(), image.width * 4) == 0 ||
        WebPEncode(&config, &picture) == 0)
        return codec_failure("webp", "error " + std::to_string(picture.error_code));
    return EncodedBytes(writer.mem, writer.mem + writer.size);
}

}  // namespace

bool is_one_colour(const Rgba8Image& image) noexcept {
    return image.bytes.size() >= 4 &&
           std::memcmp(image.bytes.data(), image.bytes.data() + 4, image.bytes.size() - 4) == 0;
}

Rgba8Image to_straight_alpha(const Rgba8Image& premultiplied) {
    Rgba8Image straight = premultiplied;
    const auto& codes = steps_to_srgb();
    for (std::size_t i = 0; i < straight.bytes.size(); i += 4) {
        const std::uint32_t alpha = straight.bytes[i + 3];
        if (alpha == 255) continue;
        for (std::size_t channel = i; channel < i + 3; ++channel) {
            const std::uint32_t steps = srgb_to_steps[straight.bytes[channel]];
            straight.bytes[channel] =
                alpha == 0 ? std::uint8_t{0}
                           : codes[std::min<std::uint32_t>((steps * 255 + alpha / 2) / alpha, 65535)];
        }
    }
    return straight;
}

Result<EncodedBytes> encode_page(const Rgba8Image& image, PageFormat format, TexelKind kind) {
    switch (format) {
        case PageFormat::png:
            return encode_png(image, kind);
        case PageFormat::jpg:
            return encode_jpeg(image);
        case PageFormat::webp:
            return encode_webp(image);
        case PageFormat::rgba:
            break;
    }
    return image.bytes;
}

Result<EncodedBytes> compress_zstd(std::span<const std::uint8_t> bytes) {
    struct Release {
        void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
    };
    thread_local const std::unique_ptr<ZSTD_CCtx, Release> context{ZSTD_createCCtx()};
    if (!context) return codec_failure("zstd", "out of memory");
    EncodedBytes out(ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compressCCtx(context.get(), out.data(), out.size(), bytes.data(), bytes.size(), zstd_level);
    if (ZSTD_isError(size) != 0) return codec_failure("zstd", ZSTD_getErrorName(size));
    out.resize(size);
    return out;
}

}  // namespace tessera
