#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "shared/math/hash.h"

namespace tessera {

/// 128 bits that a client draws at random for each edit, so that a retry is not a second edit.
struct EditId {
    std::array<std::uint8_t, 16> bytes{};
    auto operator<=>(const EditId&) const = default;
};

/// As a UUID: "f81d4fae-7dec-41d0-a765-00a0c91e6bf6".
std::string to_string(const EditId& id);

/// 32 hexadecimal digits of either case, with or without a UUID's four hyphens; nothing for other text.
std::optional<EditId> edit_id_from(std::string_view text) noexcept;

/// A random UUID (RFC 4122, version 4) from the system's source of randomness.
EditId random_edit_id();

}  // namespace tessera

template <>
struct std::hash<tessera::EditId> {
    std::size_t operator()(const tessera::EditId& id) const noexcept {
        std::uint64_t halves[2];
        std::memcpy(halves, id.bytes.data(), sizeof halves);
        return tessera::mix(halves[0] ^ tessera::mix(halves[1]));
    }
};
