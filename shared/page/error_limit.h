#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

/// The most that a texel may be off, in 8-bit codes of linear light (DESIGN section 3, `max_error`). A whole
/// number of millionths, so that each limit is written in one way and no float decides.
struct ErrorLimit {
    std::uint32_t millionths = 0;  ///< 0 to 255,000,000.

    constexpr double codes() const noexcept { return millionths / 1e6; }
    /// Whether a bound of so many codes keeps it.
    constexpr bool allows(double bound_codes) const noexcept { return bound_codes <= codes(); }
    bool operator==(const ErrorLimit&) const = default;
};

/// "0.5", "2", "0.004": decimal, without sign or exponent, at most six digits behind the point, 0 to 255.
constexpr std::optional<ErrorLimit> error_limit_named(std::string_view text) noexcept {
    const std::size_t point = text.find('.');
    const std::string_view whole = text.substr(0, point);
    const std::string_view part =
        point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
    if (whole.empty() || whole.size() > 3 || (whole.size() > 1 && whole.front() == '0') || part.size() > 6 ||
        (point != std::string_view::npos && part.empty()))
        return std::nullopt;
    std::uint32_t millionths = 0;
    for (const char digit : whole) {
        if (digit < '0' || digit > '9') return std::nullopt;
        millionths = millionths * 10 + static_cast<std::uint32_t>(digit - '0');
    }
    for (std::size_t i = 0; i < 6; ++i) {
        const char digit = i < part.size() ? part[i] : '0';
        if (digit < '0' || digit > '9') return std::nullopt;
        millionths = millionths * 10 + static_cast<std::uint32_t>(digit - '0');
    }
    if (millionths > 255'000'000) return std::nullopt;
    return ErrorLimit{millionths};
}

/// The shortest text that error_limit_named() reads back.
inline std::string text_of(ErrorLimit limit) {
    std::string text = std::to_string(limit.millionths / 1'000'000);
    std::string part = std::to_string(1'000'000 + limit.millionths % 1'000'000).substr(1);
    while (!part.empty() && part.back() == '0') part.pop_back();
    if (!part.empty()) text.append(1, '.').append(part);
    return text;
}

}  // namespace tessera
