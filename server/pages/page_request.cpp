#include "server/pages/page_request.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include <xxhash.h>

#include "server/pages/page_encoder.h"

namespace tessera {

std::uint64_t page_revision(const Scene& scene, PageKey key) noexcept {
    // One revision for every gutter that can be asked for; and composites are evaluated in whole blocks of 32
    // texels (server/pattern/descent.cpp), whose edits the gutter sees
    constexpr std::int32_t block = 32;
    return scene.page_revisions.of(key, scene.document ? block : max_gutter_texels);
}

PageId page_id(const PageRequest& request) {
    // Every field at its full width, in a fixed order
    std::array<std::byte, 192> bytes;
    std::size_t size = 0;
    const auto add = [&](const void* value, std::size_t length) {
        std::memcpy(bytes.data() + size, value, length);
        size += length;
    };
    const auto add_integer = [&](auto value) { add(&value, sizeof value); };
    const std::string& fingerprint = request.scene->fingerprint;
    add_integer(XXH3_64bits(fingerprint.data(), fingerprint.size()));
    add(fingerprint.data(), std::min<std::size_t>(fingerprint.size(), 64));
    add_integer(page_revision(*request.scene, request.key));
    add_integer(encoder_version);
    add_integer(request.key.x);
    add_integer(request.key.y);
    add_integer(request.key.level);
    add_integer(request.options.format);
    add_integer(request.options.coding);
    add_integer(request.options.gutter);
    add_integer(request.options.accuracy);
    add_integer(request.options.channels);
    // The first slice goes without, so that pages of flat scenes keep their ids
    if (request.options.slice != 0) add_integer(request.options.slice);
    if (request.options.max_error) {
        add("max_error", 9);
        add_integer(request.options.max_error->millionths);
    }
    if (request.options.parameter != 0) {
        add("parameter", 9);
        add_integer(request.options.parameter);
    }
    const XXH128_hash_t digest = XXH3_128bits(bytes.data(), size);
    return {digest.high64, digest.low64};
}

PageId page_id(PageId line, Step from) {
    if (from == always) return line;
    const std::array<std::uint64_t, 3> fields{line.high, line.low, static_cast<std::uint64_t>(from)};
    const XXH128_hash_t digest = XXH3_128bits(fields.data(), sizeof fields);
    return {digest.high64, digest.low64};
}

std::string etag_of(PageId id) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string tag(34, '"');
    for (std::size_t i = 0; i < 16; ++i) {
        tag[1 + i] = digits[id.high >> (60 - 4 * i) & 15];
        tag[17 + i] = digits[id.low >> (60 - 4 * i) & 15];
    }
    return tag;
}

}  // namespace tessera
