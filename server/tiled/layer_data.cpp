#include "server/tiled/layer_data.h"

#include <charconv>
#include <memory>
#include <string>

#include <libdeflate.h>
#include <zstd.h>

namespace tessera {
namespace {

Error invalid(const std::string& what) { return {ErrorCode::invalid_input, what}; }

bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

Result<std::vector<std::uint32_t>> from_csv(std::string_view text, std::size_t count) {
    std::vector<std::uint32_t> tiles;
    tiles.reserve(std::min(count, text.size()));
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto skip = [&] {
        while (at != end && is_space(*at)) ++at;
    };
    for (skip(); at != end; skip()) {
        std::uint32_t tile = 0;
        const auto [next, failure] = std::from_chars(at, end, tile);
        if (failure != std::errc{}) return invalid("holds what is no number in its list of tiles");
        if (tiles.size() == count)
            return invalid("lists more tiles than its " + std::to_string(count) + " cells");
        tiles.push_back(tile);
        at = next;
        skip();
        if (at != end && *at++ != ',') return invalid("lists tiles that no comma separates");
    }
    if (tiles.size() != count)
        return invalid("lists " + std::to_string(tiles.size()) + " tiles for " + std::to_string(count) +
                       " cells");
    return tiles;
}

int digit_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    return c == '/' ? 63 : -1;
}

/// RFC 4648, section 4; white space is passed over.
Result<std::vector<std::uint8_t>> from_base64(std::string_view text) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int digits = 0;
    bool ended = false;
    for (const char c : text) {
        if (is_space(c)) continue;
        const int digit = digit_of(c);
        if (c == '=') ended = true;
        if (c != '=' && (digit < 0 || ended)) return invalid("holds what is no base64");
        if (c == '=') continue;
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        if (++digits % 4 == 0)
            for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
    if (digits % 4 == 1) return invalid("holds base64 that ends too early");
    if (digits % 4 == 2) bytes.push_back(static_cast<std::uint8_t>(bits >> 4));
    if (digits % 4 == 3) {
        bytes.push_back(static_cast<std::uint8_t>(bits >> 10));
        bytes.push_back(static_cast<std::uint8_t>(bits >> 2));
    }
    return bytes;
}

/// Unpacks exactly as many bytes as `out` has; false otherwise.
bool unpack(std::string_view compression, const std::vector<std::uint8_t>& packed,
            std::vector<std::uint8_t>& out) {
    if (compression == "zstd")
        return ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size()) == out.size();
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater{
        libdeflate_alloc_decompressor(), libdeflate_free_decompressor};
    const auto inflate = compression == "gzip" ? libdeflate_gzip_decompress : libdeflate_zlib_decompress;
    return inflate(inflater.get(), packed.data(), packed.size(), out.data(), out.size(), nullptr) ==
           LIBDEFLATE_SUCCESS;
}

}  // namespace

Result<std::vector<std::uint32_t>> decode_layer(std::string_view text, std::string_view encoding,
                                                std::string_view compression, std::size_t count) {
    if (encoding == "csv") return from_csv(text, count);
    if (encoding != "base64")
        return invalid("has the encoding \"" + std::string{encoding} + "\"; csv or base64");
    const auto packed = from_base64(text);
    if (!packed) return packed.error();
    const std::string cells = std::to_string(count) + " cells";
    std::vector<std::uint8_t> bytes;
    if (compression.empty()) {
        if (packed->size() != count * 4)
            return invalid("holds " + std::to_string(packed->size()) + " bytes for " + cells);
        bytes = *packed;
    } else {
        if (compression != "zlib" && compression != "gzip" && compression != "zstd")
            return invalid("has the compression \"" + std::string{compression} + "\"; zlib, gzip or zstd");
        // Deflate and Zstandard pack at most some thousandfold; more is no layer but a trap
        if (count * 4 / 65536 > packed->size()) return invalid("is too short for " + cells);
        bytes.resize(count * 4);
        if (!unpack(compression, *packed, bytes))
            return invalid("does not unpack to the tiles of " + cells + ": it is damaged");
    }
    std::vector<std::uint32_t> tiles(count);
    for (std::size_t i = 0; i < count; ++i)
        tiles[i] = std::uint32_t{bytes[4 * i]} | std::uint32_t{bytes[4 * i + 1]} << 8 |
                   std::uint32_t{bytes[4 * i + 2]} << 16 | std::uint32_t{bytes[4 * i + 3]} << 24;
    return tiles;
}

}  // namespace tessera
