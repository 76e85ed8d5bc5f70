#pragma once

#include <string>

namespace tessera {

/// A random UUID (RFC 4122, version 4) for a new edit, so that sending it again is no second edit.
std::string new_edit_id();

}  // namespace tessera
