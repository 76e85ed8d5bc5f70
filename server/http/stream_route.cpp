#include <algorithm>

#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "server/http/edit_access.h"
#include "server/http/routes.h"

namespace tessera {
namespace {

namespace http = boost::beast::http;

constexpr const char* protocol = "tessera.stream.1";

/// 16 bytes in base64 (RFC 6455, 4.2.1).
bool is_key(std::string_view text) {
    return text.size() == 24 && text.ends_with("==") && std::all_of(text.begin(), text.end() - 2, [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '+' || c == '/';
           });
}

}  // namespace

Routes::Outcome Routes::stream(const RequestHead& request, const Scene& scene) {
    if (!request.is(http::verb::get))
        return text_answer(405, "text/plain; charset=utf-8", "a stream is opened with GET\n",
                           "Cache-Control: no-store\r\nAllow: GET, OPTIONS\r\n");
    // A browser opens a stream for any page that asks, and the page then speaks with what the person may do
    if (is_foreign(request))
        return refusal_answer({403, "Origin: pages of another site may not open a stream here", false});
    const auto& fields = request.message;
    if (!boost::beast::websocket::is_upgrade(fields))
        return refusal_answer({426, "a stream is a WebSocket of the subprotocol tessera.stream.1", false});
    if (request[http::field::sec_websocket_version] != "13")
        return refusal_answer({426, "Sec-WebSocket-Version: 13", false});
    if (fields.count(http::field::sec_websocket_key) != 1 || !is_key(request[http::field::sec_websocket_key]))
        return refusal_answer({400, "Sec-WebSocket-Key: 16 bytes in base64", false});
    if (!http::token_list{fields[http::field::sec_websocket_protocol]}.exists(protocol))
        return refusal_answer({400, "Sec-WebSocket-Protocol: tessera.stream.1", false});
    PendingStream pending{scene.id, false, std::string{bearer_token(request)}};
    // Who is on this machine edits without a token
    pending.edits_without_token = may_edit_without_token(request);
    return pending;
}

}  // namespace tessera
