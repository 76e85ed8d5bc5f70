#pragma once

#include <variant>

#include "server/access/access.h"
#include "server/http/request_head.h"

namespace tessera {

/// Whether a web page of somebody else's makes the request: browsers say from where, and a page that a person
/// visits must not edit a server of theirs.
bool is_foreign(const RequestHead& request);

/// The token in "Authorization: Bearer …"; empty: none.
std::string_view bearer_token(const RequestHead& request);

/// Whether a request may edit, by POST or over a stream that it opens; else the answer that it gets.
std::variant<Access::Decision, Refusal> may_edit(const RequestHead& request, const Access& access);
/// The same, as if it said no token.
bool may_edit_without_token(const RequestHead& request);

}  // namespace tessera
