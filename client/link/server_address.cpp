#include "client/link/server_address.h"

#include <algorithm>
#include <charconv>

namespace tessera {
namespace {

Error refuse(std::string_view url, std::string_view why) {
    return {ErrorCode::invalid_input, "server address '" + std::string{url} + "': " + std::string{why}};
}

bool is_host_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '-' || c == '_';
}

bool is_ipv6_character(char c) {
    return (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || (c >= '0' && c <= '9') || c == ':' || c == '.';
}

}  // namespace

std::string ServerAddress::authority() const {
    const std::string name = host.find(':') == std::string::npos ? host : "[" + host + "]";
    return port == 80 ? name : name + ":" + std::to_string(port);
}

Result<ServerAddress> parse_server_address(std::string_view url) {
    std::string_view rest = url;
    if (const auto end = rest.find("://"); end != std::string_view::npos) {
        const std::string_view scheme = rest.substr(0, end);
        if (scheme == "https")
            return refuse(url, "https is not spoken here; put http:// or a proxy in front");
        if (scheme != "http") return refuse(url, "the scheme must be http, as in http://127.0.0.1:7070");
        rest.remove_prefix(end + 3);
    }
    if (const auto slash = rest.find_first_of("/?#"); slash != std::string_view::npos) {
        if (rest.substr(slash) != "/") return refuse(url, "leave out what follows host and port");
        rest = rest.substr(0, slash);
    }
    if (rest.find('@') != std::string_view::npos) return refuse(url, "leave out the user before '@'");

    // Split host and port; an IPv6 host stands in brackets
    ServerAddress address;
    std::string_view port;
    bool has_port = false;
    if (rest.starts_with('[')) {
        const auto close = rest.find(']');
        if (close == std::string_view::npos) return refuse(url, "']' is missing after the IPv6 address");
        address.host = rest.substr(1, close - 1);
        if (address.host.empty() || !std::all_of(address.host.begin(), address.host.end(), is_ipv6_character))
            return refuse(url, "between '[' and ']' stands an IPv6 address");
        rest.remove_prefix(close + 1);
        if (!rest.empty() && !rest.starts_with(':')) return refuse(url, "after ']' only ':port' may follow");
        has_port = !rest.empty();
        port = rest.substr(has_port ? 1 : 0);
    } else {
        const auto colon = rest.find(':');
        has_port = colon != std::string_view::npos;
        address.host = rest.substr(0, colon);
        if (has_port) port = rest.substr(colon + 1);
        if (address.host.empty()) return refuse(url, "the host is missing, as in http://127.0.0.1:7070");
        if (address.host.size() > 255 ||
            !std::all_of(address.host.begin(), address.host.end(), is_host_character))
            return refuse(url, "the host holds characters that no host name has");
    }
    if (has_port) {
        const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
        if (error != std::errc{} || end != port.data() + port.size() || address.port == 0)
            return refuse(url, "the port must be a number from 1 to 65535");
    }
    return address;
}

}  // namespace tessera
