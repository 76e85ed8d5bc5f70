#include "client/link/edit_id.h"

#include <array>
#include <cstdint>
#include <random>

namespace tessera {

std::string new_edit_id() {
    std::random_device source;  // the system's
    std::array<std::uint8_t, 16> bytes{};
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
        const std::uint32_t drawn = source();
        for (std::size_t b = 0; b < 4; ++b) bytes[i + b] = static_cast<std::uint8_t>(drawn >> (8 * b));
    }
    bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0f) | 0x40);
    bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3f) | 0x80);
    constexpr const char* digits = "0123456789abcdef";
    std::string id;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i == 4 || i == 6 || i == 8 || i == 10) id += '-';
        id += digits[bytes[i] >> 4];
        id += digits[bytes[i] & 15];
    }
    return id;
}

}  // namespace tessera
