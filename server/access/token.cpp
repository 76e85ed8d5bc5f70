#include "server/access/token.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <sodium.h>
#include <sys/file.h>
#include <unistd.h>

#include "server/access/access.h"
#include "server/files/whole_file.h"

namespace tessera {

namespace {

constexpr std::string_view prefix = "tessera_";  ///< So that scanners for secrets know one.

/// An open file; closing it lets go of its lock.
struct Descriptor {
    int number = -1;
    Descriptor() = default;
    explicit Descriptor(int opened) : number{opened} {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number >= 0) ::close(number);
    }
};

}  // namespace

std::string make_token() {
    if (sodium_init() < 0) std::abort();  // no source of randomness: nothing that we say would be secret
    std::array<unsigned char, 32> random{};
    randombytes_buf(random.data(), random.size());
    constexpr int variant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
    std::array<char, sodium_base64_ENCODED_LEN(32, variant)> text{};
    sodium_bin2base64(text.data(), text.size(), random.data(), random.size(), variant);
    return std::string{prefix} + text.data();
}

std::string hash_of_token(std::string_view token) {
    std::string hash(crypto_hash_sha256_BYTES, '\0');
    crypto_hash_sha256(reinterpret_cast<unsigned char*>(hash.data()),
                       reinterpret_cast<const unsigned char*>(token.data()), token.size());
    return hash;
}

Result<void> check_holder_name(std::string_view name) {
    const auto is_fine = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view{"._@+-"}.find(c) != std::string_view::npos;
    };
    if (!name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), is_fine)) return {};
    return Error{ErrorCode::invalid_input, "the name \"" + std::string{name.substr(0, 64)} +
                                               "\": takes 1 to 64 letters, digits and . _ @ + -"};
}

Result<std::chrono::sys_seconds> expiry_from(std::string_view day) {
    const Error wrong{ErrorCode::invalid_input,
                      "the expiry \"" + std::string{day.substr(0, 64)} + "\": is no day; write YYYY-MM-DD"};
    if (day.size() != 10 || day[4] != '-' || day[7] != '-') return wrong;
    int numbers[3] = {};
    const std::string_view parts[3] = {day.substr(0, 4), day.substr(5, 2), day.substr(8, 2)};
    for (std::size_t i = 0; i < 3; ++i)
        for (const char digit : parts[i]) {
            if (digit < '0' || digit > '9') return wrong;
            numbers[i] = numbers[i] * 10 + (digit - '0');
        }
    const std::chrono::year_month_day date{std::chrono::year{numbers[0]},
                                           std::chrono::month{static_cast<unsigned>(numbers[1])},
                                           std::chrono::day{static_cast<unsigned>(numbers[2])}};
    if (!date.ok() || numbers[0] < 1970) return wrong;
    return std::chrono::sys_days{date};
}

std::string token_line(std::string_view role, std::string_view name, std::string_view token,
                       std::string_view expires) {
    const std::string hash = hash_of_token(token);
    std::array<char, 2 * crypto_hash_sha256_BYTES + 1> hex{};
    sodium_bin2hex(hex.data(), hex.size(), reinterpret_cast<const unsigned char*>(hash.data()), hash.size());
    std::string line{role};
    line.append(" ").append(name).append(" ").append(hex.data());
    if (!expires.empty()) line.append(" ").append(expires);
    return line;
}

Result<void> add_token_line(const std::filesystem::path& file, const std::string& line) {
    const auto failed = [&] {
        return Error{ErrorCode::io_failure, file.string() + ": " + std::generic_category().message(errno)};
    };
    const Descriptor opened{::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0600)};
    if (opened.number < 0 || ::flock(opened.number, LOCK_EX) != 0) return failed();
    if (const auto whole = Access::load(file); !whole) return whole.error();

    const ::off_t end = ::lseek(opened.number, 0, SEEK_END);
    char last = '\n';
    if (end < 0 || (end > 0 && ::pread(opened.number, &last, 1, end - 1) != 1)) return failed();
    const std::string text = (last == '\n' ? "" : "\n") + line + "\n";
    const ::ssize_t written = ::write(opened.number, text.data(), text.size());
    if (written != static_cast<::ssize_t>(text.size()) || ::fsync(opened.number) != 0) {
        const Error error = failed();
        // A part of a line would make the whole file unreadable
        if (::ftruncate(opened.number, end) != 0) return failed();
        return error;
    }
    return sync_folder(file.parent_path().empty() ? "." : file.parent_path());
}

}  // namespace tessera
