#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "shared/result/result.h"

namespace tessera {

/// A token nobody can guess: "tessera_" and 256 random bits in base64url.
std::string make_token();

/// SHA-256, 32 bytes.
std::string hash_of_token(std::string_view token);

/// Error: invalid_input, where `name` cannot stand in a file of tokens: 1 to 64 letters, digits and . _ @ + -
Result<void> check_holder_name(std::string_view name);

/// The first second of a day, in UTC, written as YYYY-MM-DD. Error: invalid_input.
Result<std::chrono::sys_seconds> expiry_from(std::string_view day);

/// A line of a file of tokens (Access::load), without its end. `expires` is a day, or empty for never.
std::string token_line(std::string_view role, std::string_view name, std::string_view token,
                       std::string_view expires);

/// Adds a line to a file of tokens, and waits for the disk; makes the file, for its owner alone, if it is not
/// there. Two that do so at a time both get their line in. Errors: io_failure, and all of Access::load(): a
/// file that it refuses is left as it is.
Result<void> add_token_line(const std::filesystem::path& file, const std::string& line);

}  // namespace tessera
