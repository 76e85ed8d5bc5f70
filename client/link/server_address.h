#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/result/result.h"

namespace tessera {

/// Where a server listens.
struct ServerAddress {
    std::string host;  ///< A name or a number; IPv6 without brackets.
    std::uint16_t port = 80;

    /// host:port as the Host field carries it: IPv6 in brackets, port 80 left out.
    std::string authority() const;
    std::string url() const { return "http://" + authority(); }
    bool operator==(const ServerAddress&) const = default;
};

/// Reads `http://host[:port][/]`; the scheme may be left out. Anything else (https, a path, a query, a user,
/// a port out of 1 to 65535) is `invalid_input`, and the detail says what to write instead.
Result<ServerAddress> parse_server_address(std::string_view url);

}  // namespace tessera
