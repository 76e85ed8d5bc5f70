#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

namespace tessera::tests {

/// FNV-1a, by words.
class BitHash {
  public:
    void add(std::uint32_t word) noexcept { value_ = (value_ ^ word) * 0x100000001b3u; }
    std::string text() const {
        std::array<char, 17> digits{};
        std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(value_));
        return digits.data();
    }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace tessera::tests
