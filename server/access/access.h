#pragma once

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

/// Who may edit: whoever is on this machine, and from elsewhere whoever holds a token of the role editor.
/// Immutable; shared between threads.
class Access {
  public:
    /// Loopback alone.
    Access() = default;

    /// A file of tokens: a line each, "role name sha256-of-the-token-in-hex [expiry as YYYY-MM-DD]"; '#'
    /// begins a comment. Errors: io_failure, invalid_input; the message names file and line.
    static Result<Access> load(const std::filesystem::path& file);

    struct Decision {
        bool allowed = false;
        std::string name;  ///< Of the token's holder; empty on loopback without a token.
        std::string why;   ///< Where not allowed: what would help.
    };
    /// Takes the same time for every wrong token.
    Decision may_edit(const Caller& caller) const;

    bool has_tokens() const noexcept { return !holders_.empty(); }

  private:
    struct Holder {
        std::string name;
        std::string hash;  ///< 32 bytes
        bool editor = false;
        std::int64_t expires = 0;  ///< Seconds since 1970; 0: never.
    };
    std::vector<Holder> holders_;
};

}  // namespace tessera
