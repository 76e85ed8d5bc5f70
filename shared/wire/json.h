#pragma once

#include <string>
#include <string_view>

#include <google/protobuf/message.h>

#include "shared/result/result.h"

namespace tessera {

/// Reads protobuf JSON into `message`. An unknown field, a wrong type or broken JSON is `invalid_input`, with
/// protobuf's own words, which name the field's path, behind `where` (the file or the request).
Result<void> read_json(std::string_view text, std::string_view where, google::protobuf::Message& message);

/// The same, but fields that we do not know are skipped: for answers of a newer server.
Result<void> read_json_leniently(std::string_view text, std::string_view where,
                                 google::protobuf::Message& message);

/// The binary form of protobuf JSON of the message type of this full name, such as "tessera.proto.Scene".
/// Errors as read_json(). Takes some four times the text's size at most.
Result<std::string> json_to_binary(std::string_view text, const std::string& type);

/// Indented protobuf JSON with the names of the .proto file, ending in a newline.
std::string write_json(const google::protobuf::Message& message);

/// The same on one line: of a file of JSON lines.
std::string write_json_line(const google::protobuf::Message& message);

/// The same, but only the fields that are set: for files that people read and edit.
std::string write_brief_json(const google::protobuf::Message& message);

}  // namespace tessera
