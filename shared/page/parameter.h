#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

/// What a request may tell animations, a number from 0 to 1, is counted in 65536ths.
inline constexpr std::int32_t parameter_one = 65536;

/// "0.25", at most 16 decimals, no sign and no exponent: down to a 65536th. Nothing for what is no such
/// number.
inline std::optional<std::int32_t> parameter_named(std::string_view text) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    if (text.empty() || text.size() > 18 || (text[0] != '0' && text[0] != '1')) return std::nullopt;
    std::int32_t value = text[0] == '1' ? parameter_one : 0;
    if (text.size() == 1) return value;
    if (text[1] != '.' || text.size() == 2 || !std::all_of(text.begin() + 2, text.end(), is_digit))
        return std::nullopt;
    // 16 decimals of 2^-16 are exact in integers: 10^16 · 2^16 is below 2^70
    __extension__ unsigned __int128 part = 0, whole = 1;
    for (const char digit : text.substr(2)) {
        part = part * 10 + static_cast<unsigned>(digit - '0');
        whole *= 10;
    }
    value += static_cast<std::int32_t>(part * parameter_one / whole);
    return value <= parameter_one && (text[0] == '0' || part == 0) ? std::optional{value} : std::nullopt;
}

/// The shortest way to write it that parameter_named() reads back: "0.25".
inline std::string text_of_parameter(std::int32_t parameter) {
    if (parameter <= 0) return "0";
    if (parameter >= parameter_one) return "1";
    std::uint64_t scale = 1;
    for (int decimals = 1;; ++decimals) {
        scale *= 10;
        const std::uint64_t part =
            (static_cast<std::uint64_t>(parameter) * scale + parameter_one - 1) / parameter_one;
        if (part * parameter_one / scale != static_cast<std::uint64_t>(parameter)) continue;
        std::string digits = std::to_string(part);
        return "0." + std::string(static_cast<std::size_t>(decimals) - digits.size(), '0') + digits;
    }
}

}  // namespace tessera
