#include "client/link/page_body.h"

#include <algorithm>
#include <memory>
#include <new>

#include <zstd.h>

namespace tessera {
namespace {

struct FreeDecoder {
    void operator()(ZSTD_DCtx* decoder) const { ZSTD_freeDCtx(decoder); }
};

Result<std::string> unpack_zstd(std::string_view packed, std::size_t max_bytes) {
    const std::unique_ptr<ZSTD_DCtx, FreeDecoder> decoder{ZSTD_createDCtx()};
    if (!decoder) throw std::bad_alloc{};
    // The frame may state its size; believe it only as far as the limit, and grow where it is silent
    std::string content;
    const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
    const bool is_stated = stated != ZSTD_CONTENTSIZE_UNKNOWN && stated != ZSTD_CONTENTSIZE_ERROR;
    if (is_stated && stated > max_bytes)
        return Error{ErrorCode::io_failure,
                     "the answer unpacks to more than " + std::to_string(max_bytes) + " bytes"};
    content.resize(is_stated ? static_cast<std::size_t>(stated) : std::min(max_bytes, packed.size() * 4));

    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{content.data(), content.size(), 0};
    for (;;) {
        const std::size_t left = ZSTD_decompressStream(decoder.get(), &out, &in);
        if (ZSTD_isError(left))
            return Error{ErrorCode::io_failure, std::string{"damaged zstd data: "} + ZSTD_getErrorName(left)};
        if (left == 0 && in.pos == in.size) break;
        if (out.pos < out.size) {
            if (in.pos == in.size) return Error{ErrorCode::io_failure, "zstd data ends too early"};
            continue;
        }
        if (content.size() >= max_bytes)
            return Error{ErrorCode::io_failure,
                         "the answer unpacks to more than " + std::to_string(max_bytes) + " bytes"};
        content.resize(std::min(max_bytes, content.size() * 2 + 64));
        out.dst = content.data();
        out.size = content.size();
    }
    content.resize(out.pos);
    return content;
}

}  // namespace

Result<std::string> decode_body(std::string body, std::string_view content_encoding, std::size_t max_bytes) {
    if (content_encoding == "zstd") return unpack_zstd(body, max_bytes);
    if (!content_encoding.empty() && content_encoding != "identity")
        return Error{ErrorCode::io_failure,
                     "the answer's encoding '" + std::string{content_encoding} + "' was not asked for"};
    if (body.size() > max_bytes)
        return Error{ErrorCode::io_failure,
                     "the answer is longer than " + std::to_string(max_bytes) + " bytes"};
    return body;
}

}  // namespace tessera
