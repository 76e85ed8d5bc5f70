#pragma once

#include <filesystem>
#include <memory>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "tests/support/temporary_folder.h"

namespace tessera::tests {

/// Id number `n`: tests count where clients draw.
inline EditId id_of(std::uint64_t n) {
    EditId id;
    for (std::size_t i = 0; i < 8; ++i) id.bytes[15 - i] = static_cast<std::uint8_t>(n >> (8 * i));
    return id;
}

inline Append edit(std::uint64_t n, std::string bytes = "edit", Revision known = 0) {
    return {id_of(n), std::move(bytes), known, {}};
}

inline JournalOptions scene_options() {
    JournalOptions options;
    options.scene = "garden";
    return options;
}

/// An engine that the conformance tests are run on.
struct Engine {
    std::string name;
    bool lasts = false;  ///< What was appended is there when it is opened again.
    std::unique_ptr<Journal> (*open)(const std::filesystem::path& folder, JournalOptions options) = nullptr;
};
inline void PrintTo(const Engine& engine, std::ostream* out) { *out << engine.name; }

inline const Engine memory_engine{"memory", false, [](const std::filesystem::path&, JournalOptions options) {
                                      return memory_journal(std::move(options));
                                  }};
inline const Engine sqlite_engine{
    "sqlite", true,
    [](const std::filesystem::path& folder, JournalOptions options) -> std::unique_ptr<Journal> {
        SilentProgress progress;
        auto journal = open_journal(folder, std::move(options), progress);
        if (journal) return std::move(*journal);
        ADD_FAILURE() << journal.error().detail;
        return nullptr;
    }};

}  // namespace tessera::tests
