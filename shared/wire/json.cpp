#include "shared/wire/json.h"

#include <memory>

#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver.h>
#include <google/protobuf/util/type_resolver_util.h>

#include "shared/wire/json_errors.h"

namespace tessera {
namespace {

Result<void> read(std::string_view text, std::string_view where, google::protobuf::Message& message,
                  bool lenient) {
    google::protobuf::util::JsonParseOptions options;
    options.ignore_unknown_fields = lenient;
    const auto status = google::protobuf::util::JsonStringToMessage(std::string{text}, &message, options);
    if (status.ok()) return {};
    return Error{ErrorCode::invalid_input,
                 std::string{where} + ": " +
                     explained_json_error({status.message().data(), status.message().size()},
                                          *message.GetDescriptor())};
}

std::string write(const google::protobuf::Message& message, bool with_unset_fields, bool indented = true) {
    google::protobuf::util::JsonPrintOptions options;
    options.add_whitespace = indented;
    options.preserve_proto_field_names = true;
    options.always_print_primitive_fields = with_unset_fields;
    std::string text;
    // Fails only for messages with invalid embedded types, which ours do not have
    (void)google::protobuf::util::MessageToJsonString(message, &text, options);
    return text;
}

}  // namespace

Result<void> read_json(std::string_view text, std::string_view where, google::protobuf::Message& message) {
    return read(text, where, message, false);
}

Result<void> read_json_leniently(std::string_view text, std::string_view where,
                                 google::protobuf::Message& message) {
    return read(text, where, message, true);
}

Result<std::string> json_to_binary(std::string_view text, const std::string& type) {
    constexpr const char* prefix = "type.googleapis.com";
    const std::unique_ptr<google::protobuf::util::TypeResolver> resolver{
        google::protobuf::util::NewTypeResolverForDescriptorPool(
            prefix, google::protobuf::DescriptorPool::generated_pool())};
    std::string binary;
    google::protobuf::io::ArrayInputStream in{text.data(), static_cast<int>(text.size())};
    google::protobuf::io::StringOutputStream out{&binary};
    const auto status = google::protobuf::util::JsonToBinaryStream(
        resolver.get(), std::string{prefix} + "/" + type, &in, &out);
    if (status.ok()) return binary;
    const std::string_view said{status.message().data(), status.message().size()};
    const auto* known = google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(type);
    return Error{ErrorCode::invalid_input,
                 known == nullptr ? std::string{said} : explained_json_error(said, *known)};
}

std::string write_json(const google::protobuf::Message& message) { return write(message, true); }

std::string write_json_line(const google::protobuf::Message& message) {
    return write(message, true, false) + '\n';
}

std::string write_brief_json(const google::protobuf::Message& message) { return write(message, false); }

}  // namespace tessera
