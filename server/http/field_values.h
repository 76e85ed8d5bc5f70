#pragma once

#include <algorithm>
#include <string_view>

#include <boost/beast/core/string.hpp>

namespace tessera {

inline std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

/// Cuts the next element off a list of header values, or of their parameters.
inline std::string_view next_element(std::string_view& list, char separator = ',') {
    const std::size_t end = std::min(list.find(separator), list.size());
    const std::string_view element = trimmed(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
    return element;
}

inline bool equals_ignoring_case(std::string_view a, std::string_view b) {
    return boost::beast::iequals({a.data(), a.size()}, {b.data(), b.size()});
}

}  // namespace tessera
