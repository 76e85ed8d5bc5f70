#include "client/load/body_check.h"

#include <utility>

#include <xxhash.h>

namespace tessera {
namespace {
std::uint64_t hash_of(std::string_view text) { return XXH3_64bits(text.data(), text.size()); }
}  // namespace

BodyCheck::Verdict BodyCheck::compare(std::string_view target, std::string_view etag, std::string_view body) {
    const Seen now{hash_of(etag), hash_of(body)};
    const std::uint64_t address = hash_of(target);
    const auto found = seen_.find(address);
    if (found == seen_.end()) {
        if (seen_.size() >= max_addresses_) return Verdict::no_room;
        seen_.emplace(address, now);
        return Verdict::first_seen;
    }
    const Seen before = std::exchange(found->second, now);
    if (before.body == now.body) return before.etag == now.etag ? Verdict::same : Verdict::retagged;
    return before.etag == now.etag ? Verdict::mismatch : Verdict::changed;
}

}  // namespace tessera
