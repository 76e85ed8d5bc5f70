#pragma once

#include <string>
#include <string_view>

#include "shared/result/result.h"

namespace tessera {

/// A scene file's fault: the field's path, what is wrong there, and what would be right.
inline Error field_error(std::string_view path, std::string_view what) {
    return {ErrorCode::invalid_input, std::string{path} + ": " + std::string{what}};
}

}  // namespace tessera
