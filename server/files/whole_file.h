#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "shared/result/result.h"

namespace tessera {

/// Reads a regular file of at most `max_bytes`. Errors name the file: io_failure, or invalid_input if it is
/// larger.
Result<std::string> read_whole_file(const std::filesystem::path& file, std::int64_t max_bytes);

/// Writes the file and waits until the disk has it. Error: io_failure, which names the file.
Result<void> write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// Waits until the disk has a folder's entries, after files were made or renamed in it.
Result<void> sync_folder(const std::filesystem::path& folder);

/// Removes the folder, if it is still there, when its maker is done, however that ends.
struct RemovedAtEnd {
    const std::filesystem::path folder;

    explicit RemovedAtEnd(std::filesystem::path path) : folder{std::move(path)} {}
    RemovedAtEnd(const RemovedAtEnd&) = delete;
    RemovedAtEnd& operator=(const RemovedAtEnd&) = delete;
    ~RemovedAtEnd() {
        std::error_code failure;
        std::filesystem::remove_all(folder, failure);
    }
};

/// Puts the folder `made` in the place of `folder`, which may be there already; both have one parent.
/// Afterwards `made` is gone, or is what was there before. Error: io_failure, which names `folder`.
Result<void> move_into_place(const std::filesystem::path& made, const std::filesystem::path& folder);

}  // namespace tessera
