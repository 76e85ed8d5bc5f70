#pragma once

#include <chrono>
#include <cstring>

#include "server/journal/journal.h"

namespace tessera::sqlite {

// Values of ours as SQLite keeps them

inline EditId id_of(std::string_view bytes) noexcept {
    EditId id;
    std::memcpy(id.bytes.data(), bytes.data(), std::min(bytes.size(), id.bytes.size()));
    return id;
}

inline JournalTime time_of(std::int64_t milliseconds) noexcept {
    return JournalTime{std::chrono::milliseconds{milliseconds}};
}

inline std::int64_t integer(Revision revision) noexcept { return static_cast<std::int64_t>(revision); }

}  // namespace tessera::sqlite
