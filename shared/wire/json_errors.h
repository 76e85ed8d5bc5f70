#pragma once

#include <string>
#include <string_view>

#include <google/protobuf/descriptor.h>

namespace tessera {

/// What Protobuf's JSON parser says of a text for a message of `type`, for people: which field, what is wrong
/// with it, and the field that was probably meant. Whatever is not known here stays as it was said.
std::string explained_json_error(std::string_view said, const google::protobuf::Descriptor& type);

}  // namespace tessera
