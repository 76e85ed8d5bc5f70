#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "shared/result/result.h"

namespace tessera {

/// Who asks, as far as that decides what is allowed.
struct Caller {
    bool from_loopback = false;  ///< And not through a proxy.
    std::string_view token;      ///< As the client said it; empty: none.
};

/// Who may edit: whoever is on this machine and says no token, and from anywhere whoever holds one of the
/// role editor. A token that is said counts, here as elsewhere: a wrong one is refused, and not passed over.
/// Immutable; shared between threads.
class Access {
  public:
    /// Loopback alone.
    Access() = default;

    /// A file of tokens: a line each, "role name sha256-of-the-token-in-hex [expiry as YYYY-MM-DD]"; '#'
    /// begins a comment. Roles are editor and viewer; a token is good through the day of its expiry, in UTC.
    /// Errors: io_failure, invalid_input, also for a file that others than its owner may write; the message
    /// names file and line.
    static Result<Access> load(const std::filesystem::path& file);

    struct Decision {
        bool allowed = false;
        std::string name;         ///< Of the token's holder; empty on loopback without a token.
        std::string why;          ///< Where not allowed: what would help.
        bool other_role = false;  ///< Not allowed, though the token is good: its role does not suffice.
        bool any_author = false;  ///< May make edits in anybody's name.
    };
    using Time = std::chrono::sys_seconds;
    /// Takes the same time for every wrong token.
    Decision may_edit(const Caller& caller) const;
    Decision may_edit(const Caller& caller, Time now) const;

    bool has_tokens() const noexcept { return !holders_.empty(); }

  private:
    struct Holder {
        std::string name;
        std::string hash;  ///< 32 bytes
        bool editor = false;
        std::int64_t expires = 0;  ///< Seconds since 1970; 0: never.
    };
    static Result<Holder> read_line(std::string_view line);

    std::vector<Holder> holders_;
};

/// Whose name an edit bears that `allowed` lets in and that says `author`: on this machine anybody's, from
/// elsewhere the holder's alone. Error: invalid_input, where it says another.
Result<std::string> author_of(const std::string& author, const Access::Decision& allowed);

}  // namespace tessera
