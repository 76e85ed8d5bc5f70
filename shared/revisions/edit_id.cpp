#include "shared/revisions/edit_id.h"

#include <random>

namespace tessera {
namespace {

int digit_of(char c) noexcept {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

bool hyphen_before(std::size_t byte) noexcept { return byte == 4 || byte == 6 || byte == 8 || byte == 10; }

}  // namespace

std::string to_string(const EditId& id) {
    std::string text;
    for (std::size_t i = 0; i < id.bytes.size(); ++i) {
        if (hyphen_before(i)) text += '-';
        text += "0123456789abcdef"[id.bytes[i] >> 4];
        text += "0123456789abcdef"[id.bytes[i] & 15];
    }
    return text;
}

std::optional<EditId> edit_id_from(std::string_view text) noexcept {
    const bool hyphens = text.size() == 36;
    if (!hyphens && text.size() != 32) return std::nullopt;
    EditId id;
    std::size_t at = 0;
    for (std::size_t i = 0; i < id.bytes.size(); ++i) {
        if (hyphens && hyphen_before(i) && text[at++] != '-') return std::nullopt;
        const int high = digit_of(text[at++]), low = digit_of(text[at++]);
        if (high < 0 || low < 0) return std::nullopt;
        id.bytes[i] = static_cast<std::uint8_t>(high << 4 | low);
    }
    return id;
}

EditId random_edit_id() {
    std::random_device device;
    EditId id;
    for (std::size_t i = 0; i < id.bytes.size(); i += 4) {
        const std::uint32_t drawn = device();
        for (std::size_t byte = 0; byte < 4; ++byte)
            id.bytes[i + byte] = static_cast<std::uint8_t>(drawn >> (8 * byte));
    }
    id.bytes[6] = static_cast<std::uint8_t>((id.bytes[6] & 0x0f) | 0x40);
    id.bytes[8] = static_cast<std::uint8_t>((id.bytes[8] & 0x3f) | 0x80);
    return id;
}

}  // namespace tessera
