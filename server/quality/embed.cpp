#include <memory>
#include <string_view>

#include <turbojpeg.h>

#include "server/pages/page_encoder.h"
#include "server/quality/report_page.h"

namespace tessera {
namespace {

/// Less than pages have: pictures to judge by, several of them in one file.
constexpr int jpeg_quality = 80;

std::string base64(const EncodedBytes& bytes) {
    static constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const std::uint32_t three = std::uint32_t{bytes[i]} << 16 |
                                    (left > 1 ? std::uint32_t{bytes[i + 1]} << 8 : 0) |
                                    (left > 2 ? bytes[i + 2] : 0U);
        out += digits[three >> 18];
        out += digits[three >> 12 & 63];
        out += left > 1 ? digits[three >> 6 & 63] : '=';
        out += left > 2 ? digits[three & 63] : '=';
    }
    return out;
}

}  // namespace

Result<EmbeddedPicture> embed_png(const Rgba8Image& image) {
    const auto bytes = encode_page(image, PageFormat::png);
    if (!bytes) return bytes.error();
    return EmbeddedPicture{"data:image/png;base64," + base64(*bytes), image.width, image.height};
}

Result<EmbeddedPicture> embed_jpeg(const Rgba8Image& image) {
    struct Release {
        void operator()(void* codec) const noexcept { tjDestroy(codec); }
    };
    const std::unique_ptr<void, Release> codec{tjInitCompress()};
    if (!codec) return Error{ErrorCode::io_failure, tjGetErrorStr2(nullptr)};
    EncodedBytes out(tjBufSize(image.width, image.height, TJSAMP_420));
    unsigned char* begin = out.data();
    unsigned long size = out.size();
    if (tjCompress2(codec.get(), image.bytes.data(), image.width, 0, image.height, TJPF_RGBX, &begin, &size,
                    TJSAMP_420, jpeg_quality, TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC) != 0)
        return Error{ErrorCode::io_failure, tjGetErrorStr2(codec.get())};
    out.resize(size);
    return EmbeddedPicture{"data:image/jpeg;base64," + base64(out), image.width, image.height};
}

}  // namespace tessera
