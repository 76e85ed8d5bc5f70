#include "client/view/record/session_file.h"

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>

#include <xxhash.h>
#include <zstd.h>

#include "client/view/record/session.pb.h"

namespace tessera {
namespace {

constexpr std::array<char, 16> magic{'T', 'E', 'S', 'S', 'E', 'R', 'A', ' ',
                                     'S', 'E', 'S', 'S', 'I', 'O', 'N', '\n'};
constexpr std::size_t most_block_bytes = 256u << 20;  ///< Of an entry, unpacked
constexpr int zstd_level = 1;

template <class Number>
void put(std::string& bytes, Number number) {
    for (std::size_t i = 0; i < sizeof number; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xff);
}

template <class Number>
Number number_at(const char* bytes) {
    Number number = 0;
    for (std::size_t i = 0; i < sizeof number; ++i)
        number |= static_cast<Number>(static_cast<std::uint8_t>(bytes[i])) << (8 * i);
    return number;
}

std::string block_of(const std::string& raw) {
    std::string packed(ZSTD_compressBound(raw.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), zstd_level));
    std::string block;
    put(block, static_cast<std::uint32_t>(packed.size()));
    put(block, static_cast<std::uint32_t>(raw.size()));
    put(block, static_cast<std::uint64_t>(XXH3_64bits(packed.data(), packed.size())));
    return block + packed;
}

constexpr std::size_t block_head_bytes = 16;

}  // namespace

class SessionWriter::Worker {
  public:
    Worker(std::filesystem::path file, std::ofstream stream)
        : file_{std::move(file)}, stream_{std::move(stream)}, thread_{[this] { run(); }} {}
    ~Worker() {
        {
            const std::lock_guard lock{mutex_};
            is_ending_ = true;
        }
        changed_.notify_one();
        thread_.join();
    }

    bool add(std::string raw) {
        {
            const std::lock_guard lock{mutex_};
            if (!problem_.empty()) return false;
            if (waiting_bytes_ + raw.size() > most_waiting_bytes) {
                problem_ = file_.string() + ": the disk is slower than what is to be recorded";
                return false;
            }
            waiting_bytes_ += raw.size();
            waiting_.push_back(std::move(raw));
        }
        changed_.notify_one();
        return true;
    }
    std::uint64_t bytes() const { return written_; }
    std::string problem() const {
        const std::lock_guard lock{mutex_};
        return problem_;
    }

  private:
    void run() {
        for (;;) {
            std::string raw;
            {
                std::unique_lock lock{mutex_};
                changed_.wait(lock, [&] { return is_ending_ || !waiting_.empty(); });
                if (waiting_.empty()) return;
                raw = std::move(waiting_.front());
                waiting_.pop_front();
            }
            const std::string block = block_of(raw);
            stream_.write(block.data(), static_cast<std::streamsize>(block.size()));
            stream_.flush();
            written_ += block.size();
            const std::lock_guard lock{mutex_};
            waiting_bytes_ -= raw.size();
            if (!stream_ && problem_.empty()) problem_ = file_.string() + ": cannot be written any further";
        }
    }

    std::filesystem::path file_;
    std::ofstream stream_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> waiting_;
    std::uint64_t waiting_bytes_ = 0;
    std::atomic<std::uint64_t> written_{magic.size() + sizeof session_version};
    bool is_ending_ = false;
    std::string problem_;
    std::thread thread_;  // last: it uses all others
};

Result<std::unique_ptr<SessionWriter>> SessionWriter::open(const std::filesystem::path& file) {
    std::ofstream stream{file, std::ios::binary | std::ios::trunc};
    std::string head(magic.begin(), magic.end());
    put(head, session_version);
    stream.write(head.data(), static_cast<std::streamsize>(head.size()));
    stream.flush();
    if (!stream) return Error{ErrorCode::io_failure, "--record: " + file.string() + ": cannot be written"};
    return std::unique_ptr<SessionWriter>{
        new SessionWriter{std::make_unique<Worker>(file, std::move(stream))}};
}

SessionWriter::SessionWriter(std::unique_ptr<Worker> worker) : worker_{std::move(worker)} {}
SessionWriter::~SessionWriter() = default;

bool SessionWriter::add(const view::SessionEntry& entry) { return worker_->add(entry.SerializeAsString()); }
std::uint64_t SessionWriter::bytes() const { return worker_->bytes(); }
std::string SessionWriter::problem() const { return worker_->problem(); }

Result<SessionReader> SessionReader::open(const std::filesystem::path& file) {
    const auto wrong = [&](const std::string& what) {
        return Error{ErrorCode::invalid_input, "--replay: " + file.string() + ": " + what};
    };
    std::ifstream stream{file, std::ios::binary};
    if (!stream) return wrong("cannot be read");
    std::array<char, magic.size() + sizeof session_version> head{};
    stream.read(head.data(), head.size());
    if (!stream || std::memcmp(head.data(), magic.data(), magic.size()) != 0)
        return wrong("is no recorded session");
    const auto version = number_at<std::uint32_t>(head.data() + magic.size());
    if (version != session_version)
        return wrong("is of version " + std::to_string(version) + " of the format, and this program knows " +
                     std::to_string(session_version) + "; replay it with the program that recorded it");
    return SessionReader{file, std::move(stream)};
}

bool SessionReader::broken(const std::string& how) {
    trouble_ = file_.string() + ": " + how + " after entry " + std::to_string(entries_);
    return false;
}

bool SessionReader::next(view::SessionEntry& entry) {
    if (has_ended_ || !trouble_.empty()) return false;
    std::array<char, block_head_bytes> head{};
    stream_.read(head.data(), head.size());
    if (stream_.gcount() == 0) return broken("ends without an end");
    if (!stream_) return broken("is torn");
    const auto packed_bytes = number_at<std::uint32_t>(head.data());
    const auto raw_bytes = number_at<std::uint32_t>(head.data() + 4);
    if (packed_bytes > most_block_bytes || raw_bytes > most_block_bytes) return broken("is damaged");
    // By and by: a damaged size asks for no more memory than the file has bytes
    std::string packed;
    while (packed.size() < packed_bytes) {
        const std::size_t had = packed.size(), more = std::min<std::size_t>(packed_bytes - had, 1u << 20);
        packed.resize(had + more);
        stream_.read(packed.data() + had, static_cast<std::streamsize>(more));
        if (!stream_) return broken("is torn");
    }
    if (XXH3_64bits(packed.data(), packed.size()) != number_at<std::uint64_t>(head.data() + 8))
        return broken("is damaged");
    if (ZSTD_getFrameContentSize(packed.data(), packed.size()) != raw_bytes) return broken("is damaged");
    std::string raw(raw_bytes, '\0');
    const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), packed.data(), packed.size());
    if (ZSTD_isError(size) || size != raw.size() || !entry.ParseFromString(raw)) return broken("is damaged");
    ++entries_;
    has_ended_ = entry.has_end();
    return true;
}

}  // namespace tessera
