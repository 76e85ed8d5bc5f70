#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <unordered_map>

namespace tessera {

/// Remembers a hash of each address's bytes and ETag, and compares them when the address is answered again.
class BodyCheck {
  public:
    /// Addresses remembered; what comes after is not checked. An entry takes some 50 bytes.
    explicit BodyCheck(std::size_t max_addresses = std::size_t{1} << 20) : max_addresses_{max_addresses} {}

    enum class Verdict {
        first_seen,
        same,
        mismatch,  ///< Other bytes under the same ETag, or without one.
        changed,   ///< Other bytes under another ETag.
        retagged,  ///< The same bytes under another ETag.
        no_room,
    };
    Verdict compare(std::string_view target, std::string_view etag, std::string_view body);

  private:
    struct Seen {
        std::uint64_t etag;
        std::uint64_t body;
    };
    std::size_t max_addresses_;
    std::unordered_map<std::uint64_t, Seen> seen_;
};

}  // namespace tessera
