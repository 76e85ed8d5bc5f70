#include "server/http/request_head.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include <boost/beast/core/string.hpp>
#include <boost/beast/http/parser.hpp>

namespace tessera {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

Refusal malformed(std::string why) { return {400, std::move(why), true}; }

/// What Beast forgives and proxies disagree about: folded lines, bare CR or LF, NUL (RFC 9112, 2.2 and 5.2).
bool has_odd_lines(std::string_view raw) {
    for (std::size_t i = 0; i < raw.size(); ++i) {
        const char c = raw[i];
        if (c == '\0') return true;
        if (c == '\n' && (i == 0 || raw[i - 1] != '\r')) return true;
        if (c == '\r' && (i + 1 == raw.size() || raw[i + 1] != '\n')) return true;
        if (c == '\n' && i + 1 < raw.size() && (raw[i + 1] == ' ' || raw[i + 1] == '\t')) return true;
    }
    return false;
}

/// A name, an IPv4 or a bracketed IPv6 address, and perhaps a port.
bool is_authority(std::string_view text) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
               c == '-' || c == '_' || c == ':' || c == '[' || c == ']';
    };
    return !text.empty() && text.size() <= 255 && text.front() != ':' &&
           std::all_of(text.begin(), text.end(), allowed);
}

}  // namespace

bool is_posted_to(std::string_view path) noexcept {
    return path.starts_with("/scenes/") && (path.ends_with("/sample") || path.ends_with("/edits"));
}

std::optional<Refusal> RequestHead::parse(std::string_view raw, const SessionLimits& limits) {
    if (has_odd_lines(raw)) return malformed("header lines end in CR LF and are not folded");
    http::request_parser<http::empty_body> parser;
    parser.header_limit(static_cast<std::uint32_t>(limits.head_bytes));
    parser.body_limit(boost::none);  // a declared body is refused below, with its own status
    beast::error_code failure;
    parser.put(boost::asio::const_buffer{raw.data(), raw.size()}, failure);
    if (failure == http::error::header_limit) return Refusal{431, "the header is too long", true};
    if (failure && failure != http::error::need_more) return malformed(failure.message());
    if (!parser.is_header_done()) return malformed("the header is not complete");
    message = parser.release();
    keep_alive = message.keep_alive();

    if (message.target().size() > limits.target_bytes) {
        return Refusal{414, "the address is longer than " + std::to_string(limits.target_bytes) + " bytes",
                       true};
    }
    if (static_cast<std::size_t>(std::distance(message.begin(), message.end())) > limits.fields)
        return Refusal{431, "more than " + std::to_string(limits.fields) + " header fields", true};
    if (message.version() != 10 && message.version() != 11)
        return malformed("only HTTP/1.0 and HTTP/1.1 are spoken here");
    if (auto refusal = check_framing()) return refusal;
    if (auto refusal = check_host()) return refusal;

    if (message.method() == http::verb::unknown) return Refusal{501, "unknown method", true};
    if (message.method() == http::verb::connect) return Refusal{405, "this is not a proxy", true};
    if (auto refusal = check_target(limits)) return refusal;
    if (is(http::verb::post) && is_posted_to(path)) return check_body(limits);
    const bool has_body = message.count(http::field::transfer_encoding) != 0 ||
                          (message.count(http::field::content_length) != 0 &&
                           message[http::field::content_length].find_first_not_of('0') != std::string::npos);
    if (!is(http::verb::get) && !is(http::verb::head) && !is(http::verb::options))
        return Refusal{405, "only GET, HEAD and OPTIONS", has_body};
    if (has_body) return Refusal{413, "requests have no body here", true};
    if (message.count(http::field::expect) != 0) return Refusal{417, "nothing to expect", true};
    return std::nullopt;
}

std::optional<Refusal> RequestHead::check_framing() const {
    const auto transfer_encodings = message.count(http::field::transfer_encoding);
    const auto content_lengths = message.count(http::field::content_length);
    if (transfer_encodings + content_lengths > 1) return malformed("more than one framing header field");
    if (transfer_encodings == 1 &&
        (message.version() < 11 || !beast::iequals(message[http::field::transfer_encoding], "chunked")))
        return malformed("Transfer-Encoding: only chunked, and only in HTTP/1.1");
    if (content_lengths == 1) {
        const auto length = message[http::field::content_length];
        if (length.empty() || length.size() > 18 ||
            !std::all_of(length.begin(), length.end(), [](char c) { return c >= '0' && c <= '9'; }))
            return malformed("Content-Length is not a number of bytes");
    }
    return std::nullopt;
}

/// Of a POST to where one belongs.
std::optional<Refusal> RequestHead::check_body(const SessionLimits& limits) {
    if (message.count(http::field::content_length) == 0)
        return Refusal{411, "Content-Length says how long the body is; it is not sent in chunks", true};
    const std::string_view length = (*this)[http::field::content_length];  // digits, at most 18 of them
    std::from_chars(length.data(), length.data() + length.size(), body_bytes);
    if (body_bytes > limits.body_bytes)
        return Refusal{
            413,
            "the body is longer than " + std::to_string(limits.body_bytes) + " bytes; send less at a time",
            true};
    const auto expectation = message[http::field::expect];
    expects_continue = message.version() >= 11 && beast::iequals(expectation, "100-continue");
    if (message.count(http::field::expect) > 1 ||
        (!expectation.empty() && !beast::iequals(expectation, "100-continue")))
        return Refusal{417, "nothing to expect but 100-continue", true};
    return std::nullopt;
}

std::optional<Refusal> RequestHead::check_host() {
    const auto hosts = message.count(http::field::host);
    if (hosts > 1 || (hosts == 0 && message.version() >= 11)) return malformed("exactly one Host is needed");
    host = hosts == 0 ? std::string_view{"localhost"} : (*this)[http::field::host];
    if (!is_authority(host)) return malformed("Host is not a name or address with an optional port");
    return std::nullopt;
}

std::optional<Refusal> RequestHead::check_target(const SessionLimits&) {
    std::string_view target = view(message.target());
    if (!std::all_of(target.begin(), target.end(), [](char c) { return c > ' ' && c < '\x7f'; }))
        return malformed("the address has bytes that must be percent-encoded");
    if (target.find_first_of("#\\\"<>^`{|}") != std::string_view::npos)
        return malformed("the address has characters that must be percent-encoded");

    // The absolute form names the host itself (RFC 9112, 3.2.2)
    if (beast::iequals(beast::string_view{target.data(), std::min<std::size_t>(target.size(), 7)},
                       "http://")) {
        target.remove_prefix(7);
        const std::size_t end = std::min(target.find_first_of("/?"), target.size());
        host = target.substr(0, end);
        if (!is_authority(host)) return malformed("the address names no host");
        target.remove_prefix(end);
        if (target.empty() || target.front() == '?') {  // no path is "/"
            path = "/";
            query = target.substr(std::min<std::size_t>(target.size(), 1));
            return std::nullopt;
        }
    }
    if (target == "*" && is(http::verb::options)) {
        path = target;
        return std::nullopt;
    }
    if (target.empty() || target.front() != '/') return malformed("the address does not begin with '/'");
    const std::size_t question = target.find('?');
    path = target.substr(0, question);
    query = question == std::string_view::npos ? std::string_view{} : target.substr(question + 1);
    return std::nullopt;
}

}  // namespace tessera
