#pragma once

#include <cstddef>
#include <memory>
#include <string>

struct XXH3_state_s;

namespace tessera {

/// 64 bits that name some bytes (XXH3): the same ones on every machine. No defence against forgery.
class Digest {
  public:
    Digest();
    void add(const void* bytes, std::size_t count);
    std::string hex() const;  ///< 16 digits

  private:
    struct Release {
        void operator()(XXH3_state_s* state) const noexcept;
    };
    std::unique_ptr<XXH3_state_s, Release> state_;
};

}  // namespace tessera
