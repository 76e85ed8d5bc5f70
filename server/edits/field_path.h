#pragma once

#include <string>
#include <string_view>

#include "shared/result/result.h"

namespace google::protobuf {
class Message;
}

namespace tessera {

namespace proto {
class Block;
class Value;
}  // namespace proto

/// Whether `block` lets people change the field of this path: it is listed, or a field that it is part of.
bool lists_as_editable(const proto::Block& block, std::string_view path);

/// A field of a block by its path as in the scene file, "materials[1].entries[0].weight": puts what `value`
/// says there (nothing: unset), and what was there into `old`. Error: invalid_input, if there is no such
/// field, it is no single number, name or Value, or cannot hold that. Nothing has changed then.
Result<void> exchange_field(google::protobuf::Message& message, std::string_view path,
                            const proto::Value& value, proto::Value& old);

}  // namespace tessera
