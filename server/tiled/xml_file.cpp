#include "server/tiled/xml_file.h"

#include <charconv>
#include <cmath>

#include "server/files/whole_file.h"

namespace tessera {
namespace {

constexpr std::int64_t max_xml_bytes = std::int64_t{1} << 26;

/// "layer "Ground"", or the element's name alone.
std::string path_of(const pugi::xml_node& node) {
    std::string path = node.name();
    for (const char* key : {"name", "id", "gid", "tileid", "source"})
        if (const pugi::xml_attribute label = node.attribute(key))
            return path + " " + key + "=\"" + label.value() + "\"";
    return path;
}

}  // namespace

Result<pugi::xml_document> read_xml(const std::filesystem::path& file, const char* root) {
    const auto text = read_whole_file(file, max_xml_bytes);
    if (!text) return text.error();
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(text->data(), text->size(), pugi::parse_default);
    if (!parsed)
        return Error{ErrorCode::invalid_input, file.string() + ": is no well-formed XML (" +
                                                   parsed.description() + " at byte " +
                                                   std::to_string(parsed.offset) + "); save it again"};
    if (std::string_view{document.document_element().name()} != root)
        return Error{ErrorCode::invalid_input, file.string() + ": its root is <" +
                                                   document.document_element().name() + ">, and not <" +
                                                   root + ">; name a file of the Tiled editor"};
    return document;
}

std::int64_t XmlNumbers::integer(const pugi::xml_node& node, const char* name, std::int64_t least,
                                 std::int64_t most, std::optional<std::int64_t> missing) {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute && missing) return *missing;
    const std::string_view text = attribute.value();
    std::int64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure == std::errc{} && end == text.data() + text.size() && value >= least && value <= most)
        return value;
    fail(node, std::string{name} + " is " + (attribute ? "\"" + std::string{text} + "\"" : "missing") +
                   "; an integer from " + std::to_string(least) + " to " + std::to_string(most));
    return least;
}

double XmlNumbers::number(const pugi::xml_node& node, const char* name, double missing) {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return missing;
    const std::string_view text = attribute.value();
    double value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure == std::errc{} && end == text.data() + text.size() && std::isfinite(value)) return value;
    fail(node, std::string{name} + " is \"" + std::string{text} + "\"; a number");
    return missing;
}

Error XmlNumbers::wrong(const pugi::xml_node& node, const std::string& what) const {
    return {ErrorCode::invalid_input, file_.string() + ": " + path_of(node) + ": " + what};
}

void XmlNumbers::fail(const pugi::xml_node& node, const std::string& what) {
    if (!error_) error_ = wrong(node, what);
}

}  // namespace tessera
