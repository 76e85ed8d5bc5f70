#include "server/access/access.h"

#include <algorithm>

#include <sodium.h>
#include <sys/stat.h>

#include "server/access/token.h"
#include "server/files/whole_file.h"

namespace tessera {

namespace {

constexpr std::int64_t max_file_bytes = std::int64_t{1} << 20;

std::vector<std::string_view> words_of(std::string_view line) {
    constexpr std::string_view blank = " \t\r";
    std::vector<std::string_view> words;
    for (std::size_t at = 0; (at = line.find_first_not_of(blank, at)) != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(blank, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

Error wrong(std::string detail) { return {ErrorCode::invalid_input, std::move(detail)}; }

}  // namespace

Result<Access::Holder> Access::read_line(std::string_view line) {
    const auto words = words_of(line);
    if (words.size() < 3 || words.size() > 4)
        return wrong("a line is \"role name sha256-of-the-token [YYYY-MM-DD]\"; tessera token writes one");
    Holder holder;
    holder.editor = words[0] == "editor";
    if (!holder.editor && words[0] != "viewer")
        return wrong("there is no role \"" + std::string{words[0]} + "\"; roles are editor and viewer");
    if (const auto named = check_holder_name(words[1]); !named) return named.error();
    holder.name = words[1];
    holder.hash.resize(crypto_hash_sha256_BYTES);
    std::size_t bytes = 0;
    const char* end = nullptr;
    if (sodium_hex2bin(reinterpret_cast<unsigned char*>(holder.hash.data()), holder.hash.size(),
                       words[2].data(), words[2].size(), nullptr, &bytes, &end) != 0 ||
        bytes != holder.hash.size() || end != words[2].data() + words[2].size())
        return wrong("the hash is no SHA-256; it has 64 hexadecimal digits");
    if (words.size() == 4) {
        const auto day = expiry_from(words[3]);
        if (!day) return day.error();
        holder.expires = (*day + std::chrono::days{1}).time_since_epoch().count();
    }
    return holder;
}

Result<Access> Access::load(const std::filesystem::path& file) {
    const auto text = read_whole_file(file, max_file_bytes);
    if (!text) return text.error();
    // Whoever can add a line can edit
    struct stat status {};
    if (::stat(file.c_str(), &status) == 0 && (status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
        return wrong(file.string() + ": others may write it; chmod 600 it");

    Access access;
    std::string_view rest = *text;
    for (int number = 1; !rest.empty(); ++number) {
        const std::size_t length = std::min(rest.find('\n'), rest.size());
        const std::string_view line = rest.substr(0, std::min(rest.find('#'), length));
        rest.remove_prefix(std::min(length + 1, rest.size()));
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        const auto in_line = [&](const std::string& what) {
            return wrong(file.string() + ":" + std::to_string(number) + ": " + what);
        };
        auto holder = read_line(line);
        if (!holder) return in_line(holder.error().detail);
        for (const Holder& other : access.holders_)
            if (other.hash == holder->hash) return in_line("the hash stands in an earlier line already");
        access.holders_.push_back(std::move(*holder));
    }
    return access;
}

Access::Decision Access::may_edit(const Caller& caller) const {
    return may_edit(caller, std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
}

Access::Decision Access::may_edit(const Caller& caller, Time now) const {
    // Nothing said is no token, whatever the file holds
    const std::string hash = caller.token.empty() ? std::string{} : hash_of_token(caller.token);
    const Holder* found = nullptr;
    for (const Holder& holder : holders_)
        if (!hash.empty() && sodium_memcmp(holder.hash.data(), hash.data(), hash.size()) == 0)
            found = &holder;
    const bool expired =
        found != nullptr && found->expires != 0 && now.time_since_epoch().count() >= found->expires;

    Decision decision;
    if (found != nullptr && !expired) decision.name = found->name;
    decision.any_author = caller.from_loopback;
    if (caller.from_loopback && caller.token.empty()) {
        decision.allowed = true;
    } else if (found == nullptr && caller.from_loopback) {
        // Whoever says who they are is held to it
        decision.why = "the token is not known here; on this machine none is needed: leave it out";
    } else if (found == nullptr) {
        decision.why = holders_.empty() ? "edits are taken from this machine only; tessera serve --tokens "
                                          "lets holders of a token edit from elsewhere"
                       : caller.token.empty()
                           ? "edits from elsewhere need Authorization: Bearer TOKEN"
                           : "the token is not known here; ask whoever runs the server for one";
    } else if (expired) {
        decision.why = "the token has expired; ask whoever runs the server for a new one";
    } else if (!found->editor) {
        decision.other_role = true;
        decision.why = "the token's role is viewer; editing needs one of the role editor";
    } else {
        decision.allowed = true;
    }
    return decision;
}

Result<std::string> author_of(const std::string& author, const Access::Decision& allowed) {
    if (author.empty()) return allowed.name;
    if (allowed.any_author || author == allowed.name) return author;
    return wrong("author: from elsewhere it is that of the token, \"" + allowed.name + "\"; leave it out");
}

}  // namespace tessera
