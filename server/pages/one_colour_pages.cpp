#include "server/pages/one_colour_pages.h"

#include <algorithm>
#include <cstring>

namespace tessera {

Result<EncodedBytes> encode_body(const Rgba8Image& image, TexelKind kind, PageFormat format,
                                 ContentCoding coding) {
    if (coding == ContentCoding::zstd) return compress_zstd(image.bytes);
    return encode_page(image, format, kind);
}

Result<std::shared_ptr<const EncodedBytes>> OneColourPages::encode(const Rgba8Image& image, TexelKind kind,
                                                                   PageFormat format, ContentCoding coding) {
    Known key{0, image.width, image.height, format, coding, kind};
    std::memcpy(&key.color, image.bytes.data(), sizeof key.color);
    {
        const std::lock_guard lock{mutex_};
        const auto known =
            std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& body) { return body.key == key; });
        if (known != bodies_.end()) {
            bodies_.splice(bodies_.begin(), bodies_, known);
            return known->bytes;
        }
    }
    auto encoded = encode_body(image, kind, format, coding);
    if (!encoded) return encoded.error();
    auto bytes = std::make_shared<const EncodedBytes>(std::move(*encoded));
    const std::lock_guard lock{mutex_};
    bodies_.push_front({key, bytes});
    if (bodies_.size() > kept) bodies_.pop_back();
    return bytes;
}

}  // namespace tessera
