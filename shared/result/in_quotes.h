#pragma once

#include <string>
#include <string_view>

namespace tessera {

/// A name that came from outside, for a message about it: in quotes, and cut where it is longer than names
/// are.
inline std::string in_quotes(std::string_view name) {
    constexpr std::size_t most_bytes = 64;
    if (name.size() <= most_bytes) return '"' + std::string{name} + '"';
    std::size_t end = most_bytes;
    // Not inside a character
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    return '"' + std::string{name.substr(0, end)} + "\" and so on, " + std::to_string(name.size()) + " bytes";
}

}  // namespace tessera
