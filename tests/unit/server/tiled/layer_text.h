#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <libdeflate.h>
#include <zstd.h>

namespace tessera::test {

inline std::string to_base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

inline std::string packed(std::string_view bytes, std::string_view compression) {
    std::string out(bytes.size() * 2 + 1024, '\0');
    if (compression == "zstd") {
        out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
        return out;
    }
    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> deflater{
        libdeflate_alloc_compressor(6), libdeflate_free_compressor};
    const auto pack = compression == "gzip" ? libdeflate_gzip_compress : libdeflate_zlib_compress;
    out.resize(pack(deflater.get(), bytes.data(), bytes.size(), out.data(), out.size()));
    return out;
}

/// The text of a <data> element, as the editor writes it.
inline std::string layer_text(const std::vector<std::uint32_t>& tiles, std::string_view encoding,
                              std::string_view compression) {
    std::string text, bytes;
    for (const std::uint32_t tile : tiles) {
        text += (text.empty() ? "\n" : ",\n") + std::to_string(tile);
        for (const int shift : {0, 8, 16, 24}) bytes += static_cast<char>(tile >> shift);
    }
    if (encoding == "csv") return text + "\n";
    return "\n   " + to_base64(compression.empty() ? bytes : packed(bytes, compression)) + "\n  ";
}

}  // namespace tessera::test
