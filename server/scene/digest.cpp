#include "server/scene/digest.h"

#include <xxhash.h>

namespace tessera {

void Digest::Release::operator()(XXH3_state_s* state) const noexcept { XXH3_freeState(state); }

Digest::Digest() : state_{XXH3_createState()} { XXH3_64bits_reset(state_.get()); }

void Digest::add(const void* bytes, std::size_t count) { XXH3_64bits_update(state_.get(), bytes, count); }

std::string Digest::hex() const {
    const XXH64_hash_t sum = XXH3_64bits_digest(state_.get());
    std::string digits;
    for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[sum >> shift & 15];
    return digits;
}

}  // namespace tessera
