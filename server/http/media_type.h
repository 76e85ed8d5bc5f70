#pragma once

#include <optional>
#include <string_view>

#include "server/sampling/sample_request.h"

namespace tessera {

/// The coding that a Content-Type names: application/x-protobuf (or application/protobuf) or
/// application/json, whatever its parameters.
std::optional<WireCoding> wire_coding_of(std::string_view content_type);

/// The coding that an Accept field likes best (RFC 9110, 12.5.1), `own` where it likes both alike or says
/// nothing; none if it accepts neither.
std::optional<WireCoding> accepted_coding(std::string_view accept, WireCoding own);

}  // namespace tessera
