#include "client/load/json_writer.h"

#include <array>
#include <charconv>
#include <cmath>

namespace tessera {

std::string JsonWriter::quoted(std::string_view text) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string result = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (byte < 0x20 || byte == 0x7f) {
            result += "\\u00";
            result += digits[byte >> 4];
            result += digits[byte & 15];
        } else {
            result += c;
        }
    }
    return result + '"';
}

JsonWriter& JsonWriter::raw(std::string_view name, std::string_view json) {
    if (depth_ > 0) text_ += is_first_ ? "\n" : ",\n";
    text_.append(2 * depth_, ' ');
    if (!name.empty()) text_ += quoted(name) + ": ";
    text_ += json;
    is_first_ = false;
    return *this;
}

JsonWriter& JsonWriter::open(char bracket, std::string_view name) {
    raw(name, std::string_view{&bracket, 1});
    ++depth_;
    is_first_ = true;
    return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
    --depth_;
    if (!is_first_) text_ += "\n" + std::string(2 * depth_, ' ');
    text_ += bracket;
    is_first_ = false;
    return *this;
}

JsonWriter& JsonWriter::field(std::string_view name, std::string_view text) {
    return raw(name, quoted(text));
}

JsonWriter& JsonWriter::field(std::string_view name, double number) {
    if (!std::isfinite(number)) return null(name);
    std::array<char, 32> digits{};
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    return raw(name, {digits.data(), static_cast<std::size_t>(end - digits.data())});
}

JsonWriter& JsonWriter::field(std::string_view name, std::optional<double> number) {
    return number ? field(name, *number) : null(name);
}

}  // namespace tessera
