#include "server/edits/field_path.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "proto/pattern.pb.h"

#include "shared/result/in_quotes.h"

namespace tessera {

namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

Error wrong(std::string what) { return {ErrorCode::invalid_input, std::move(what)}; }

struct Part {
    std::string_view name;
    int index = -1;  ///< In a list.
};

/// Takes the first part of a path; nothing if it cannot be read.
std::optional<Part> take_part(std::string_view& path) {
    const std::size_t end = path.find('.');
    std::string_view text = path.substr(0, end);
    path = end == std::string_view::npos ? std::string_view{} : path.substr(end + 1);
    Part part{text, -1};
    if (const std::size_t bracket = text.find('['); bracket != std::string_view::npos) {
        if (!text.ends_with(']')) return std::nullopt;
        const std::string_view digits = text.substr(bracket + 1, text.size() - bracket - 2);
        const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), part.index);
        if (read.ec != std::errc{} || read.ptr != digits.data() + digits.size() || part.index < 0)
            return std::nullopt;
        part.name = text.substr(0, bracket);
    }
    if (part.name.empty()) return std::nullopt;
    return part;
}

/// A single field: of a message, or one of a list in it.
struct Place {
    Message& in;
    const FieldDescriptor& field;
    int index;

    const google::protobuf::Reflection& reflection() const { return *in.GetReflection(); }
};

void read(const Place& place, proto::Value& old) {
    const auto& reflection = place.reflection();
    const bool listed = place.index >= 0;
    if (!listed && place.field.has_presence() && !reflection.HasField(place.in, &place.field)) return;
    const auto get = [&](auto single, auto repeated) {
        return listed ? (reflection.*repeated)(place.in, &place.field, place.index)
                      : (reflection.*single)(place.in, &place.field);
    };
    using R = google::protobuf::Reflection;
    switch (place.field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_INT32:
            return old.set_integer(get(&R::GetInt32, &R::GetRepeatedInt32));
        case FieldDescriptor::CPPTYPE_UINT32:
            return old.set_integer(get(&R::GetUInt32, &R::GetRepeatedUInt32));
        case FieldDescriptor::CPPTYPE_INT64:
            return old.set_integer(get(&R::GetInt64, &R::GetRepeatedInt64));
        case FieldDescriptor::CPPTYPE_UINT64:
            return old.set_integer(static_cast<std::int64_t>(get(&R::GetUInt64, &R::GetRepeatedUInt64)));
        case FieldDescriptor::CPPTYPE_BOOL:
            return old.set_integer(get(&R::GetBool, &R::GetRepeatedBool) ? 1 : 0);
        case FieldDescriptor::CPPTYPE_ENUM:
            return old.set_integer(get(&R::GetEnumValue, &R::GetRepeatedEnumValue));
        case FieldDescriptor::CPPTYPE_DOUBLE:
            return old.set_number(get(&R::GetDouble, &R::GetRepeatedDouble));
        case FieldDescriptor::CPPTYPE_STRING:
            return old.set_block(get(&R::GetString, &R::GetRepeatedString));
        default:
            break;
    }
}

template <class T, class Single, class Repeated>
void put(const Place& place, T value, Single single, Repeated repeated) {
    const auto& reflection = place.reflection();
    if (place.index >= 0)
        (reflection.*repeated)(&place.in, &place.field, place.index, std::move(value));
    else
        (reflection.*single)(&place.in, &place.field, std::move(value));
}

Result<void> write(const Place& place, const proto::Value& value) {
    using R = google::protobuf::Reflection;
    const auto is = value.value_case();
    if (is == proto::Value::VALUE_NOT_SET) {
        if (place.index >= 0) return wrong("cannot be unset in a list; give it a value");
        place.reflection().ClearField(&place.in, &place.field);
        return {};
    }
    const auto type = place.field.cpp_type();
    if (type == FieldDescriptor::CPPTYPE_STRING) {
        if (is != proto::Value::kBlock) return wrong("takes a name: {\"block\": …}");
        put(place, value.block(), &R::SetString, &R::SetRepeatedString);
        return {};
    }
    if (type == FieldDescriptor::CPPTYPE_DOUBLE) {
        if (is == proto::Value::kBlock) return wrong("takes a number, no block");
        const double number =
            is == proto::Value::kNumber ? value.number() : static_cast<double>(value.integer());
        put(place, number, &R::SetDouble, &R::SetRepeatedDouble);
        return {};
    }
    if (is != proto::Value::kInteger) return wrong("takes an integer: {\"integer\": …}");
    const std::int64_t integer = value.integer();
    const auto out_of_range = [&] { return wrong("cannot be " + std::to_string(integer)); };
    switch (type) {
        case FieldDescriptor::CPPTYPE_INT32:
            if (!std::in_range<std::int32_t>(integer)) return out_of_range();
            put(place, static_cast<std::int32_t>(integer), &R::SetInt32, &R::SetRepeatedInt32);
            return {};
        case FieldDescriptor::CPPTYPE_UINT32:
            if (!std::in_range<std::uint32_t>(integer)) return out_of_range();
            put(place, static_cast<std::uint32_t>(integer), &R::SetUInt32, &R::SetRepeatedUInt32);
            return {};
        case FieldDescriptor::CPPTYPE_INT64:
            put(place, integer, &R::SetInt64, &R::SetRepeatedInt64);
            return {};
        case FieldDescriptor::CPPTYPE_UINT64:
            put(place, static_cast<std::uint64_t>(integer), &R::SetUInt64, &R::SetRepeatedUInt64);
            return {};
        case FieldDescriptor::CPPTYPE_BOOL:
            if (integer != 0 && integer != 1) return out_of_range();
            put(place, integer == 1, &R::SetBool, &R::SetRepeatedBool);
            return {};
        case FieldDescriptor::CPPTYPE_ENUM:
            if (!std::in_range<int>(integer) ||
                place.field.enum_type()->FindValueByNumber(static_cast<int>(integer)) == nullptr)
                return out_of_range();
            put(place, static_cast<int>(integer), &R::SetEnumValue, &R::SetRepeatedEnumValue);
            return {};
        default:
            return wrong("is no single value; name a field in it");
    }
}

}  // namespace

bool lists_as_editable(const proto::Block& block, std::string_view path) {
    for (const std::string& listed : block.editable()) {
        if (listed == "map" || listed == "animation" || !path.starts_with(listed)) continue;
        if (path.size() == listed.size() || path[listed.size()] == '.' || path[listed.size()] == '[')
            return true;
    }
    return false;
}

Result<void> exchange_field(Message& message, std::string_view path, const proto::Value& value,
                            proto::Value& old) {
    if (value.value_case() == proto::Value::kNumber && std::isnan(value.number()))
        return wrong("is no number");
    Message* in = &message;
    std::string_view rest = path;
    for (;;) {
        const auto part = take_part(rest);
        const auto missing = [&] { return wrong("there is no field " + in_quotes(path)); };
        if (!part) return missing();
        const FieldDescriptor* field = in->GetDescriptor()->FindFieldByName(std::string{part->name});
        if (field == nullptr) return missing();
        const auto& reflection = *in->GetReflection();
        if (field->is_repeated() != (part->index >= 0))
            return wrong(in_quotes(part->name) +
                         (field->is_repeated() ? " is a list; name one of it, as [0]" : " is no list"));
        if (field->is_repeated() && part->index >= reflection.FieldSize(*in, field))
            return wrong(in_quotes(part->name) + " has " + std::to_string(reflection.FieldSize(*in, field)) +
                         " entries");
        if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
            if (!rest.empty()) return missing();
            const Place place{*in, *field, part->index};
            read(place, old);
            return write(place, value);
        }
        const bool is_value = field->message_type() == proto::Value::descriptor();
        if (is_value && rest.empty() && !field->is_repeated()) {
            if (reflection.HasField(*in, field)) old.CopyFrom(reflection.GetMessage(*in, field));
            if (value.value_case() == proto::Value::VALUE_NOT_SET)
                reflection.ClearField(in, field);
            else
                reflection.MutableMessage(in, field)->CopyFrom(value);
            return {};
        }
        if (rest.empty()) return wrong("is no single value; name a field in it");
        in = field->is_repeated() ? reflection.MutableRepeatedMessage(in, field, part->index)
                                  : reflection.MutableMessage(in, field);
    }
}

}  // namespace tessera
