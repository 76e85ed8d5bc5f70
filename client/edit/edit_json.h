#pragma once

#include <string>
#include <string_view>

#include "proto/stream.pb.h"

#include "shared/result/result.h"

namespace tessera {

/// A message as one line of JSON, without its end. Fields that are not set are left out.
std::string json_line(const google::protobuf::Message& message);

/// The line that an edit's fate is told in: what the stream would say of it.
proto::ServerMessage told_fate(const std::string& id, const proto::EditAnswer& answer);
proto::ServerMessage told_fate(const proto::EditRefused& refusal);

/// Reads an edit (proto/edit.proto) from JSON. Error: invalid_input, which begins with `where`.
Result<proto::Edit> edit_in(std::string_view json, std::string_view where);

/// The edit that undoes the last one of these lines, which are answers as told_fate() makes them. Error:
/// invalid_input.
Result<proto::Edit> undo_in(std::string_view lines, std::string_view where);

/// A file's text, or standard input's if `file` is "-"; at most `most` bytes. Errors: io_failure,
/// invalid_input.
Result<std::string> text_of(const std::string& file, std::size_t most);

}  // namespace tessera
