#include "shared/wire/json_errors.h"

#include <algorithm>
#include <vector>

#include "shared/result/nearest_name.h"

namespace tessera {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

/// The message that a path such as `sprites.patterns[0]` leads to; null if it leads elsewhere.
const Descriptor* message_at(const Descriptor* type, std::string_view path) {
    while (type != nullptr && !path.empty()) {
        const std::size_t end = std::min(path.find('.'), path.size());
        const std::string_view name = path.substr(0, std::min(path.find('['), end));
        const FieldDescriptor* field = type->FindFieldByName(std::string{name});
        if (field == nullptr) field = type->FindFieldByCamelcaseName(std::string{name});
        if (field == nullptr) return nullptr;
        type = field->message_type();
        path.remove_prefix(std::min(end + 1, path.size()));
    }
    return type;
}

/// "did you mean …", or all that there are if they are few.
std::string other_fields(const Descriptor& type, std::string_view name) {
    std::vector<std::string> fields;
    std::string all;
    for (int i = 0; i < type.field_count(); ++i) {
        fields.push_back(type.field(i)->name());
        all += (i == 0 ? "" : ", ") + fields.back();
    }
    if (const std::string meant = nearest_name(name, fields); !meant.empty())
        return "; did you mean " + meant + "?";
    constexpr std::size_t few = 12;
    return fields.empty() || fields.size() > few ? "" : "; there are " + all;
}

std::string_view meant_by(std::string_view type) {
    if (type == "TYPE_BOOL") return "true or false";
    if (type == "TYPE_STRING") return "a text in quotes";
    if (type == "TYPE_BYTES") return "bytes in base64";
    if (type == "TYPE_ENUM") return "one of the names that it may have";
    if (type == "TYPE_DOUBLE" || type == "TYPE_FLOAT") return "a number";
    if (type == "TYPE_UINT32" || type == "TYPE_FIXED32") return "a whole number from 0 to 4294967295";
    if (type == "TYPE_UINT64" || type == "TYPE_FIXED64") return "a whole number, 0 or more";
    if (type.find("INT") != type.npos || type.find("FIXED") != type.npos)
        return "a whole number in its range";
    return "";
}

}  // namespace

std::string explained_json_error(std::string_view said, const Descriptor& type) {
    // `(PATH) NAME: WHAT`, `(PATH): WHAT` or `NAME: WHAT`
    std::string_view rest = said, path, name;
    if (rest.starts_with('(')) {
        const std::size_t end = rest.find(')');
        if (end == rest.npos) return std::string{said};
        path = rest.substr(1, end - 1);
        rest.remove_prefix(end + 1);
        if (rest.starts_with(' ')) rest.remove_prefix(1);
    }
    const std::size_t colon = rest.find(": ");
    if (colon == rest.npos) return std::string{said};
    name = rest.substr(0, colon);
    rest.remove_prefix(colon + 2);
    std::string place{path};
    if (!name.empty()) place += (place.empty() ? "" : ".") + std::string{name};

    if (rest == "Cannot find field.") {
        const Descriptor* message = message_at(&type, path);
        return place + ": there is no such field" +
               (message == nullptr ? std::string{} : other_fields(*message, name));
    }
    if (rest.starts_with("Proto field is not repeating")) return place + ": is one value, and not a list";
    constexpr std::string_view invalid = "invalid value ", for_type = " for type ";
    const std::size_t at = rest.rfind(for_type);
    if (rest.starts_with(invalid) && at != rest.npos) {
        const std::string_view meant = meant_by(rest.substr(at + for_type.size()));
        const std::string_view value = rest.substr(invalid.size(), at - invalid.size());
        if (!meant.empty()) return place + ": " + std::string{value} + " is not " + std::string{meant};
    }
    return std::string{said};
}

}  // namespace tessera
