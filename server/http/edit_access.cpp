#include "server/http/edit_access.h"

#include "server/http/field_values.h"

namespace tessera {

namespace http = boost::beast::http;

namespace {

/// Whether only this machine answers to a name. Somebody else's name may be made to lead here, so that their
/// page is, for the browser, of one origin with the server (DNS rebinding).
bool is_of_this_machine(std::string_view host) {
    if (host.starts_with("[")) return host.substr(0, host.find(']')) == "[::1";
    const std::string_view name = host.substr(0, host.find(':'));
    if (name.starts_with("127.")) return name.find_first_not_of("0123456789.") == std::string_view::npos;
    return equals_ignoring_case(name, "localhost");
}

}  // namespace

bool is_foreign(const RequestHead& request) {
    const std::string_view origin = request[http::field::origin];
    if (origin.empty()) return false;
    const std::size_t scheme = origin.find("://");
    return scheme == std::string_view::npos || origin.substr(scheme + 3) != request.host;
}

std::string_view bearer_token(const RequestHead& request) {
    constexpr std::string_view scheme = "Bearer ";
    const std::string_view credentials = request[http::field::authorization];
    if (credentials.size() <= scheme.size() ||
        !equals_ignoring_case(credentials.substr(0, scheme.size()), scheme))
        return {};
    return trimmed(credentials.substr(scheme.size()));
}

namespace {

std::variant<Access::Decision, Refusal> may_edit(const RequestHead& request, std::string_view token,
                                                 const Access& access) {
    if (is_foreign(request)) return Refusal{403, "Origin: pages of another site may not edit here", false};
    Access::Decision decision = access.may_edit({request.from_loopback, token});
    if (!decision.allowed) return Refusal{decision.other_role ? 403u : 401u, decision.why, false};
    if (decision.name.empty() && !request[http::field::origin].empty() && !is_of_this_machine(request.host))
        return Refusal{403, "Host: a page edits without a token only as http://localhost", false};
    return decision;
}

}  // namespace

std::variant<Access::Decision, Refusal> may_edit(const RequestHead& request, const Access& access) {
    return may_edit(request, bearer_token(request), access);
}

bool may_edit_without_token(const RequestHead& request) {
    return std::holds_alternative<Access::Decision>(may_edit(request, {}, Access{}));
}

}  // namespace tessera
