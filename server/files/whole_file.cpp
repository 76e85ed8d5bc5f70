#include "server/files/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace tessera {
namespace {

Error failed(const std::filesystem::path& file, int code) {
    return {ErrorCode::io_failure, file.string() + ": " + std::generic_category().message(code)};
}

}  // namespace

Result<std::string> read_whole_file(const std::filesystem::path& file, std::int64_t max_bytes) {
    std::error_code failure;
    const auto status = std::filesystem::status(file, failure);
    if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    // A pipe or a device would block, or never end
    if (!std::filesystem::is_regular_file(status))
        return Error{ErrorCode::io_failure, file.string() + ": is not a file"};
    const auto size = std::filesystem::file_size(file, failure);
    if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    if (size > static_cast<std::uintmax_t>(max_bytes))
        return Error{ErrorCode::invalid_input, file.string() + ": has " + std::to_string(size) +
                                                   " bytes; at most " + std::to_string(max_bytes)};
    std::string bytes(static_cast<std::size_t>(size), '\0');
    std::ifstream in{file, std::ios::binary};
    if (!in) return failed(file, errno);
    if (!in.read(bytes.data(), std::ssize(bytes)))
        return Error{ErrorCode::io_failure, file.string() + ": cannot be read to its end"};
    return bytes;
}

Result<void> write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) return failed(file, errno);
    int code = 0;
    while (!bytes.empty() && code == 0) {
        const auto written = ::write(descriptor, bytes.data(), bytes.size());
        if (written >= 0)
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        else if (errno != EINTR)
            code = errno;
    }
    // A pipe or a terminal cannot be synced, and need not be
    if (code == 0 && ::fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS) code = errno;
    if (::close(descriptor) != 0 && code == 0) code = errno;
    if (code != 0) return failed(file, code);
    return {};
}

Result<void> sync_folder(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return failed(folder, errno);
    const int code = ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
    ::close(descriptor);
    if (code != 0) return failed(folder, code);
    return {};
}

Result<void> move_into_place(const std::filesystem::path& made, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    // One step where the file system can exchange two names; else a moment with neither
    if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, folder.c_str(), RENAME_NOREPLACE) == 0 ||
        ::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0)
        return {};
    std::error_code failure;
    if (fs::exists(folder, failure)) {
        const fs::path old = made.string() + ".old";
        fs::rename(folder, old, failure);
        if (!failure) fs::rename(made, folder, failure);
        if (!failure) fs::rename(old, made, failure);
    } else {
        fs::rename(made, folder, failure);
    }
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    return {};
}

}  // namespace tessera
