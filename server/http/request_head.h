#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "server/http/refusal.h"
#include "server/http/server_options.h"

namespace tessera {

/// Whether requests to this path are made with POST and a body: /scenes/{id}/sample and /edits.
bool is_posted_to(std::string_view path) noexcept;

/// A request as far as its header goes, past the strict gate: one Host, one framing, a sane target, a method
/// that we know. Not copyable: the views point into `message`.
class RequestHead {
  public:
    using Message = boost::beast::http::request<boost::beast::http::empty_body>;

    RequestHead() = default;
    RequestHead(const RequestHead&) = delete;
    RequestHead& operator=(const RequestHead&) = delete;

    /// Reads a whole header, its empty line included. Every byte comes from outside.
    std::optional<Refusal> parse(std::string_view raw, const SessionLimits& limits);

    Message message;
    std::string_view path;   ///< As sent: percent-encoded, starting with '/'; or "*".
    std::string_view query;  ///< Behind the '?', which is left out.
    std::string_view host;   ///< Name and port as sent, "localhost" where an HTTP/1.0 client sent none.
    bool keep_alive = false;
    std::size_t body_bytes = 0;     ///< That follow the header: of a POST, at most SessionLimits::body_bytes.
    bool from_loopback = false;     ///< Set by the session; false also for what a proxy passes on.
    bool expects_continue = false;  ///< The client waits for "100 Continue" before it sends them.

    /// The value of a header field; empty if there is none.
    std::string_view operator[](boost::beast::http::field name) const { return view(message[name]); }
    std::string_view operator[](std::string_view name) const {
        return view(message[boost::beast::string_view{name.data(), name.size()}]);
    }
    bool is(boost::beast::http::verb method) const { return message.method() == method; }

  private:
    static std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

    std::optional<Refusal> check_framing() const;
    std::optional<Refusal> check_host();
    std::optional<Refusal> check_body(const SessionLimits& limits);
    std::optional<Refusal> check_target(const SessionLimits& limits);
};

}  // namespace tessera
