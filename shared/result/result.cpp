#include "shared/result/result.h"

#include <stdexcept>

namespace tessera {

void throw_exception_from_error(const Error& error, const boost::source_location& where) {
    throw std::logic_error{"unchecked error: " + error.detail + " (" + where.file_name() + ":" +
                           std::to_string(where.line()) + ")"};
}

}  // namespace tessera
