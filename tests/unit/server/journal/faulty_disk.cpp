#include "tests/unit/server/journal/faulty_disk.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <random>

#include <sqlite3.h>

namespace tessera::tests {
namespace {

FaultyDisk* disk = nullptr;
sqlite3_vfs vfs{};

}  // namespace

/// What SQLite sees, and behind it the system's file.
struct FaultyDisk::File {
    sqlite3_file base{};
    const char* path = nullptr;
    sqlite3_file* real() noexcept { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

struct FaultyDiskCalls {
    using File = FaultyDisk::File;
    using Kind = FaultyDisk::Kind;
    static File& of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }
    static sqlite3_file* real(sqlite3_file* file) { return of(file).real(); }
    static sqlite3_vfs* system() { return static_cast<sqlite3_vfs*>(vfs.pAppData); }

    static int close(sqlite3_file* file) { return real(file)->pMethods->xClose(real(file)); }
    static int read(sqlite3_file* file, void* to, int count, sqlite3_int64 at) {
        return real(file)->pMethods->xRead(real(file), to, count, at);
    }
    static int size(sqlite3_file* file, sqlite3_int64* bytes) {
        return real(file)->pMethods->xFileSize(real(file), bytes);
    }
    static int lock(sqlite3_file* file, int level) { return real(file)->pMethods->xLock(real(file), level); }
    static int unlock(sqlite3_file* file, int level) {
        return real(file)->pMethods->xUnlock(real(file), level);
    }
    static int check_lock(sqlite3_file* file, int* held) {
        return real(file)->pMethods->xCheckReservedLock(real(file), held);
    }
    static int control(sqlite3_file* file, int operation, void* argument) {
        return real(file)->pMethods->xFileControl(real(file), operation, argument);
    }
    static int sector(sqlite3_file* file) { return real(file)->pMethods->xSectorSize(real(file)); }
    static int traits(sqlite3_file* file) { return real(file)->pMethods->xDeviceCharacteristics(real(file)); }

    static int write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 at) {
        const std::lock_guard lock{disk->mutex_};
        const FaultyDisk::Fate fate = disk->fate(Kind::write);
        if (!fate.done) return fate.code;
        sqlite3_int64 before = 0;
        real(file)->pMethods->xFileSize(real(file), &before);
        const std::string path = of(file).path;
        disk->sizes_[path] = before;
        std::uint64_t all = 0;
        for (const auto& [name, bytes_of] : disk->sizes_) all += static_cast<std::uint64_t>(bytes_of);
        const std::int64_t grows = std::max<std::int64_t>(0, at + count - before);
        if (disk->room_ && grows > 0 && all + static_cast<std::uint64_t>(grows) > *disk->room_)
            return SQLITE_FULL;
        disk->files_[path].waiting.push_back(
            {at, std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(count)), false});
        const int code = real(file)->pMethods->xWrite(real(file), bytes, count, at);
        disk->sizes_[path] = std::max<std::int64_t>(before, at + count);
        return fate.code != 0 ? fate.code : code;
    }
    static int truncate(sqlite3_file* file, sqlite3_int64 bytes) {
        const std::lock_guard lock{disk->mutex_};
        const FaultyDisk::Fate fate = disk->fate(Kind::truncate);
        if (!fate.done) return fate.code;
        disk->files_[of(file).path].waiting.push_back({bytes, {}, true});
        disk->sizes_[of(file).path] = bytes;
        const int code = real(file)->pMethods->xTruncate(real(file), bytes);
        return fate.code != 0 ? fate.code : code;
    }
    static int sync(sqlite3_file* file, int) {
        const std::lock_guard lock{disk->mutex_};
        const FaultyDisk::Fate fate = disk->fate(Kind::sync);
        FaultyDisk::Content& content = disk->files_[of(file).path];
        if (fate.done) {
            for (const FaultyDisk::Write& write : content.waiting) FaultyDisk::apply(write, content.durable);
        }
        content.waiting.clear();
        return fate.code;
    }
    static int open(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags, int* out) {
        {
            const std::lock_guard lock{disk->mutex_};
            const FaultyDisk::Fate fate = disk->fate(Kind::open);
            if (fate.code != 0) {
                file->pMethods = nullptr;
                return SQLITE_CANTOPEN;
            }
        }
        if (path != nullptr && !std::filesystem::exists(path)) disk->files_.erase(path);
        if (path != nullptr && !disk->files_.contains(path)) {
            std::ifstream there{path, std::ios::binary};
            disk->files_[path].durable.assign(std::istreambuf_iterator<char>{there}, {});
        }
        File* const made = new (file) File;
        made->path = path == nullptr ? "" : path;
        const int code = system()->xOpen(system(), path, made->real(), flags, out);
        made->base.pMethods = code == SQLITE_OK ? methods() : nullptr;
        return code;
    }
    static const sqlite3_io_methods* methods() {
        static const sqlite3_io_methods all = [] {
            sqlite3_io_methods m{};
            m.iVersion = 1;
            m.xClose = close;
            m.xRead = read;
            m.xWrite = write;
            m.xTruncate = truncate;
            m.xSync = sync;
            m.xFileSize = size;
            m.xLock = lock;
            m.xUnlock = unlock;
            m.xCheckReservedLock = check_lock;
            m.xFileControl = control;
            m.xSectorSize = sector;
            m.xDeviceCharacteristics = traits;
            return m;
        }();
        return &all;
    }
};

FaultyDisk::FaultyDisk() {
    sqlite3_vfs* const system = sqlite3_vfs_find(nullptr);
    vfs = *system;
    vfs.pNext = nullptr;
    vfs.zName = name();
    vfs.pAppData = system;
    vfs.szOsFile = static_cast<int>(sizeof(File)) + system->szOsFile;
    vfs.xOpen = FaultyDiskCalls::open;
    disk = this;
    sqlite3_vfs_register(&vfs, 0);
}

FaultyDisk::~FaultyDisk() {
    sqlite3_vfs_unregister(&vfs);
    disk = nullptr;
}

void FaultyDisk::fail(std::uint64_t number, std::uint64_t more, bool done, std::optional<Kind> kind) {
    const std::lock_guard lock{mutex_};
    fail_at_ = number;
    fail_more_ = more;
    fail_done_ = done;
    fail_kind_ = kind;
}

void FaultyDisk::heal() {
    const std::lock_guard lock{mutex_};
    fail_at_ = fail_more_ = power_lost_at_ = 0;
}

void FaultyDisk::set_room(std::optional<std::uint64_t> bytes) {
    const std::lock_guard lock{mutex_};
    room_ = bytes;
}

std::uint64_t FaultyDisk::operations() const {
    const std::lock_guard lock{mutex_};
    return operations_;
}

void FaultyDisk::lose_power(std::uint64_t number) {
    const std::lock_guard lock{mutex_};
    power_lost_at_ = operations_ + number;
}

FaultyDisk::Fate FaultyDisk::fate(Kind kind) {
    ++operations_;
    const int code = kind == Kind::sync       ? SQLITE_IOERR_FSYNC
                     : kind == Kind::write    ? SQLITE_IOERR_WRITE
                     : kind == Kind::truncate ? SQLITE_IOERR_TRUNCATE
                                              : SQLITE_CANTOPEN;
    if (power_lost_at_ != 0 && operations_ >= power_lost_at_) return {code, false};
    if (fail_at_ == 0 || (fail_kind_ && *fail_kind_ != kind)) return {};
    if (fail_at_ > 1) {
        --fail_at_;
        return {};
    }
    if (fail_more_ == 0)
        fail_at_ = 0;
    else
        --fail_more_;
    return {code, fail_done_};
}

void FaultyDisk::apply(const Write& write, std::string& content) {
    const auto from = static_cast<std::size_t>(write.offset);
    if (write.truncation) return content.resize(from);
    if (content.size() < from + write.bytes.size()) content.resize(from + write.bytes.size());
    std::copy(write.bytes.begin(), write.bytes.end(), content.begin() + write.offset);
}

void FaultyDisk::power_comes_back(std::uint64_t seed) {
    const std::lock_guard lock{mutex_};
    std::mt19937_64 random{seed};
    for (auto& [path, content] : files_) {
        if (!std::filesystem::exists(path)) continue;
        const std::uint64_t luck = random() % 3;  // nothing, all, or any of what waited reached the disk
        for (Write& write : content.waiting) {
            if (luck == 0 || (luck == 2 && random() % 2 == 0)) continue;
            const bool torn = luck == 2 && random() % 4 == 0;
            if (torn) write.bytes.resize(random() % (write.bytes.size() + 1) / 512 * 512);
            apply(write, content.durable);
        }
        std::ofstream file{path, std::ios::binary | std::ios::trunc};
        file.write(content.durable.data(), static_cast<std::streamsize>(content.durable.size()));
    }
    files_.clear();
    sizes_.clear();
    power_lost_at_ = 0;
}

}  // namespace tessera::tests
