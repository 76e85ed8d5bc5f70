#pragma once

#include <string>
#include <utility>

#include <boost/system/result.hpp>

namespace tessera {

/// What went wrong, as far as a caller would act on it differently.
enum class ErrorCode {
    malformed_request,  ///< The client's bug: it logs, and does not ask again.
    no_such_scene,      ///< The server has no scene of that name.
    no_such_page,       ///< Outside the texture: the client remembers that, and does not ask again.
    page_changed,   ///< The page has changed since the revision asked for: the client takes the present one.
    overloaded,     ///< Passing: the client shows the parent page, and asks again later.
    cancelled,      ///< Nobody waits for the answer any more.
    timed_out,      ///< The deadline passed first; the same request may succeed later.
    invalid_input,  ///< A file that a person wrote or chose is wrong: `detail` names file, field and fix.
    io_failure,     ///< The disk or the network failed.
};

/// Why there is no value. `detail` is for people; code never branches on it.
struct Error {
    ErrorCode code{};
    std::string detail;
};

/// A value, or why there is none.
template <class T>
using Result = boost::system::result<T, Error>;

/// Lets `Result::value()` on an error throw something that says what happened: a bug, since input never
/// throws.
[[noreturn]] void throw_exception_from_error(const Error& error, const boost::source_location& where);

}  // namespace tessera
