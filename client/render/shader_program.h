#pragma once

#include <string_view>

#include "client/render/gl_objects.h"
#include "shared/result/result.h"

namespace tessera {

/// Compiles and links. Error: io_failure with the driver's log.
Result<GlProgram> make_program(std::string_view vertex_source, std::string_view fragment_source);

}  // namespace tessera
