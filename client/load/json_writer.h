#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

/// Writes indented JSON with fields in the order given. Numbers that JSON does not have become null.
class JsonWriter {
  public:
    JsonWriter& begin_object(std::string_view name = {}) { return open('{', name); }
    JsonWriter& end_object() { return close('}'); }
    JsonWriter& begin_array(std::string_view name = {}) { return open('[', name); }
    JsonWriter& end_array() { return close(']'); }

    JsonWriter& field(std::string_view name, std::string_view text);
    JsonWriter& field(std::string_view name, const char* text) { return field(name, std::string_view{text}); }
    JsonWriter& field(std::string_view name, double number);
    JsonWriter& field(std::string_view name, std::optional<double> number);
    JsonWriter& field(std::string_view name, bool truth) { return raw(name, truth ? "true" : "false"); }
    JsonWriter& field(std::string_view name, std::integral auto number) {
        return raw(name, std::to_string(number));
    }
    JsonWriter& null(std::string_view name) { return raw(name, "null"); }
    /// An element of an array, already JSON.
    JsonWriter& element(std::string_view json) { return raw({}, json); }

    /// The document so far, ending in a newline.
    std::string text() const { return text_ + "\n"; }
    static std::string quoted(std::string_view text);

  private:
    JsonWriter& raw(std::string_view name, std::string_view json);
    JsonWriter& open(char bracket, std::string_view name);
    JsonWriter& close(char bracket);

    std::string text_;
    std::size_t depth_ = 0;
    bool is_first_ = true;
};

}  // namespace tessera
