#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tessera {

/// Part of every fingerprint and ETag: raise it whenever an encoder's output changes by a byte.
inline constexpr std::uint32_t encoder_version = 1;

/// How a page's texels travel.
enum class PageFormat : std::uint8_t {
    png,   ///< Lossless; straight alpha, or none where the page is opaque.
    jpg,   ///< Quality 90, 4:4:4, over black.
    webp,  ///< Lossless; straight alpha.
    rgba,  ///< Rows of premultiplied sRGB-coded RGBA, (256 + 2·gutter)² × 4 bytes.
};

inline constexpr std::array page_formats{PageFormat::png, PageFormat::jpg, PageFormat::webp,
                                         PageFormat::rgba};

/// What a raw page is wrapped in on the way; the other formats are compressed already.
enum class ContentCoding : std::uint8_t { identity, zstd };

/// The file name extension, without the dot.
constexpr std::string_view extension(PageFormat format) noexcept {
    switch (format) {
        case PageFormat::png:
            return "png";
        case PageFormat::jpg:
            return "jpg";
        case PageFormat::webp:
            return "webp";
        case PageFormat::rgba:
            break;
    }
    return "rgba";
}

constexpr std::string_view content_type(PageFormat format) noexcept {
    switch (format) {
        case PageFormat::png:
            return "image/png";
        case PageFormat::jpg:
            return "image/jpeg";
        case PageFormat::webp:
            return "image/webp";
        case PageFormat::rgba:
            break;
    }
    return "application/octet-stream";
}

/// The format that a file name extension names, written exactly as extension() writes it.
constexpr std::optional<PageFormat> page_format(std::string_view name) noexcept {
    for (const PageFormat format : page_formats)
        if (extension(format) == name) return format;
    return std::nullopt;
}

}  // namespace tessera
