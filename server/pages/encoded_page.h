#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "server/pages/page_encoder.h"
#include "server/pages/page_request.h"

namespace tessera {

/// A page as it travels, with what its evaluation did. Immutable, shared between cache and sessions.
struct EncodedPage {
    PageId id;
    PageKey key;
    PageOptions options;
    std::uint64_t revision = 0;                 ///< The page's own.
    std::shared_ptr<const EncodedBytes> bytes;  ///< The message body; one-colour pages share theirs.
    std::optional<std::uint32_t>
        colour{};         ///< Of all texels, if they have one: as in an Rgba8Image, R lowest.
    std::string prelude;  ///< What the listener says before every copy of `bytes`.
    Evaluation evaluation;
    Accuracy accuracy = Accuracy::high;  ///< That it was evaluated with.
    bool within_limit = true;            ///< Whether the bound keeps options.max_error.
    std::chrono::nanoseconds queued{}, evaluated{}, encoded{};

    /// What holding this page costs, the bookkeeping of cache and heap included.
    std::size_t memory_bytes() const noexcept {
        constexpr std::size_t bookkeeping = 320;
        return sizeof(EncodedPage) + bytes->capacity() + prelude.capacity() + bookkeeping;
    }
};

using PagePtr = std::shared_ptr<const EncodedPage>;

}  // namespace tessera
