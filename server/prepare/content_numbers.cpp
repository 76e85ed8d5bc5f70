#include "server/prepare/content_numbers.h"

#include <charconv>
#include <optional>
#include <string_view>

namespace tessera {
namespace {

std::optional<std::uint64_t> number_of(std::string_view digits) {
    std::uint64_t number = 0;
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (digits.empty() || failure != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
    return number;
}

}  // namespace

Result<std::vector<StandingChange>> parse_contents(const std::string& option, const std::string& text,
                                                   ExchangeAsset::Standing standing) {
    std::vector<StandingChange> changes;
    std::string_view left = text;
    for (bool more = true; more;) {
        const std::size_t comma = left.find(',');
        const std::string_view item = left.substr(0, comma);
        more = comma != std::string_view::npos;
        if (more) left.remove_prefix(comma + 1);

        const std::size_t colon = item.find(':');
        const auto patch = number_of(item.substr(0, colon));
        const auto content =
            colon == std::string_view::npos ? std::nullopt : number_of(item.substr(colon + 1));
        if (!patch || (colon != std::string_view::npos && !content))
            return Error{ErrorCode::invalid_input,
                         option + " " + text + ": \"" + std::string{item} +
                             "\" is neither PATCH nor PATCH:CONTENT, such as 5 or 3:7"};
        changes.push_back({*patch, content, standing});
    }
    return changes;
}

}  // namespace tessera
