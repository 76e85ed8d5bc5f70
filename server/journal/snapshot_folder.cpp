#include "server/journal/snapshot_folder.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "server/files/whole_file.h"

namespace tessera {
namespace {

constexpr std::string_view prefix = "snapshot-", unfinished = "unfinished-snapshot";
constexpr std::size_t slice_bytes = std::size_t{1}
                                    << 20;  ///< Synced apart, so that commits need not wait long.

/// What stands before the bytes, little endian.
struct Header {
    char magic[8] = {'t', 's', 'r', 's', 'n', 'a', 'p', '1'};
    std::uint64_t revision = 0;
    std::uint64_t size = 0;
    EditId lineage;
    std::uint64_t hash[2] = {0, 0};  ///< XXH3, 128 bits, of the bytes; revision and lineage are its seed.
};
static_assert(sizeof(Header) == 56 && std::endian::native == std::endian::little);

void seal(Header& header, std::string_view bytes) {
    std::uint64_t names[3] = {header.revision, 0, 0};
    std::memcpy(names + 1, header.lineage.bytes.data(), sizeof header.lineage.bytes);
    const XXH128_hash_t hash =
        XXH3_128bits_withSeed(bytes.data(), bytes.size(), XXH3_64bits(names, sizeof names));
    header.hash[0] = hash.low64;
    header.hash[1] = hash.high64;
}

/// A file descriptor that closes itself.
struct File {
    explicit File(int opened) : number{opened} {}
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File() {
        if (number >= 0) ::close(number);
    }
    int number;
};

Error failed(const char* what, const std::filesystem::path& path) {
    return {ErrorCode::io_failure, path.string() + ": " + what + ": " + std::strerror(errno)};
}

bool write_all(int file, const char* bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t written = ::write(file, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes += written;
        count -= static_cast<std::size_t>(written);
    }
    return true;
}

bool read_all(int file, char* bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t got = ::read(file, bytes, count);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        bytes += got;
        count -= static_cast<std::size_t>(got);
    }
    return true;
}

}  // namespace

Result<std::unique_ptr<SnapshotFolder>> SnapshotFolder::open(std::filesystem::path folder, EditId lineage,
                                                             Revision head) {
    std::unique_ptr<SnapshotFolder> snapshots{new SnapshotFolder{std::move(folder), lineage}};
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator{snapshots->folder_, error}) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix)) continue;
        Revision revision = 0;
        const char* const end = name.data() + name.size();
        const auto [rest, bad] = std::from_chars(name.data() + prefix.size(), end, revision);
        if (bad != std::errc{} || rest != end) continue;
        if (revision > head)
            return Error{
                ErrorCode::invalid_input,
                entry.path().string() + ": is newer than the journal beside it, which ends at revision " +
                    std::to_string(head) + ": put back the journal that it belongs to, or remove it"};
        snapshots->revisions_.push_back(revision);
    }
    if (error)
        return Error{ErrorCode::io_failure,
                     snapshots->folder_.string() + ": cannot be listed: " + error.message()};
    std::filesystem::remove(snapshots->folder_ / unfinished, error);
    std::sort(snapshots->revisions_.begin(), snapshots->revisions_.end());
    return snapshots;
}

std::filesystem::path SnapshotFolder::file_of(Revision revision) const {
    return folder_ / (std::string{prefix} + std::to_string(revision));
}

Result<void> SnapshotFolder::keep(const Snapshot& snapshot) {
    Header header;
    header.revision = snapshot.revision;
    header.size = snapshot.bytes.size();
    header.lineage = lineage_;
    seal(header, snapshot.bytes);

    const std::filesystem::path path = folder_ / unfinished;
    const auto write = [&]() -> Result<void> {
        const File file{::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
        if (file.number < 0) return failed("cannot be made", path);
        char head[sizeof header];
        std::memcpy(head, &header, sizeof header);
        if (!write_all(file.number, head, sizeof head)) return failed("cannot be written", path);
        for (std::size_t at = 0; at < snapshot.bytes.size(); at += slice_bytes) {
            const std::size_t count = std::min(slice_bytes, snapshot.bytes.size() - at);
            if (!write_all(file.number, snapshot.bytes.data() + at, count) || ::fdatasync(file.number) != 0)
                return failed("cannot be written", path);
        }
        if (::fsync(file.number) != 0) return failed("cannot be synced", path);
        if (::rename(path.c_str(), file_of(snapshot.revision).c_str()) != 0)
            return failed("cannot be renamed", path);
        return sync_folder(folder_);
    };
    if (const auto written = write(); !written) {
        ::unlink(path.c_str());
        return written.error();
    }
    if (revisions_.empty() || revisions_.back() != snapshot.revision) revisions_.push_back(snapshot.revision);
    while (revisions_.size() > 2) {
        ::unlink(file_of(revisions_.front()).c_str());
        revisions_.erase(revisions_.begin());
    }
    return {};
}

Result<Snapshot> SnapshotFolder::read(Revision revision) const {
    const std::filesystem::path path = file_of(revision);
    const File file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    if (file.number < 0) return failed("cannot be opened", path);
    struct stat information {};
    char head[sizeof(Header)];
    if (::fstat(file.number, &information) != 0 || !read_all(file.number, head, sizeof head))
        return failed("cannot be read", path);
    Header header;
    std::memcpy(&header, head, sizeof header);
    const Header expected;
    const Error damaged{ErrorCode::invalid_input, path.string() +
                                                      ": is damaged, or of another journal: remove it, and "
                                                      "its edits are replayed while they are remembered"};
    if (std::memcmp(header.magic, expected.magic, sizeof header.magic) != 0 || header.revision != revision ||
        header.lineage != lineage_ ||
        header.size != static_cast<std::uint64_t>(information.st_size) - sizeof header)
        return damaged;
    Snapshot snapshot{revision, std::string(static_cast<std::size_t>(header.size), '\0')};
    if (!read_all(file.number, snapshot.bytes.data(), snapshot.bytes.size()))
        return failed("cannot be read", path);
    Header right = header;
    seal(right, snapshot.bytes);
    if (right.hash[0] != header.hash[0] || right.hash[1] != header.hash[1]) return damaged;
    return snapshot;
}

Result<std::optional<Snapshot>> SnapshotFolder::newest(Revision at_most) {
    std::optional<Error> first;
    for (auto revision = revisions_.rbegin(); revision != revisions_.rend(); ++revision) {
        if (*revision > at_most) continue;
        Result<Snapshot> snapshot = read(*revision);
        if (snapshot) return std::optional{std::move(*snapshot)};
        if (!first) first = snapshot.error();
    }
    if (first) return *first;
    return std::optional<Snapshot>{};
}

}  // namespace tessera
