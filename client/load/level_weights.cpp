#include "client/load/level_weights.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace tessera {
namespace {

std::optional<std::uint32_t> number(std::string_view text) {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

Result<std::vector<LevelWeight>> parse_level_weights(std::string_view text, Extent extent) {
    const auto refuse = [&](const std::string& why) {
        return Error{ErrorCode::invalid_input, "levels '" + std::string{text} + "': " + why};
    };
    std::vector<LevelWeight> weights;
    const auto add = [&](std::uint32_t first, std::uint32_t last, std::uint32_t weight) {
        for (std::uint32_t level = first; level <= last; ++level)
            weights.push_back({static_cast<std::uint8_t>(level), weight});
    };
    if (text.empty()) add(0, extent.n, 1);
    for (std::string_view rest = text; !rest.empty();) {
        const auto comma = rest.find(',');
        std::string_view part = rest.substr(0, comma);
        rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
        std::uint32_t weight = 1;
        if (const auto equals = part.find('='); equals != std::string_view::npos) {
            const auto given = number(part.substr(equals + 1));
            if (!given || *given == 0 || *given > 1'000'000) return refuse("a weight is 1 to 1000000");
            weight = *given;
            part = part.substr(0, equals);
        }
        const auto dash = part.find('-');
        const auto first = number(part.substr(0, dash));
        const auto last = dash == std::string_view::npos ? first : number(part.substr(dash + 1));
        if (!first || !last) return refuse("write a level, as in 3, or a range, as in 0-8, or 0-3=4,4-8=1");
        if (*first > *last) return refuse("a range goes from the finer level to the coarser, as in 0-8");
        if (*last > extent.n) return refuse("the scene's coarsest level is " + std::to_string(extent.n));
        add(*first, *last, weight);
    }
    std::sort(weights.begin(), weights.end(), [](auto a, auto b) { return a.level < b.level; });
    const auto twice =
        std::adjacent_find(weights.begin(), weights.end(), [](auto a, auto b) { return a.level == b.level; });
    if (twice != weights.end()) return refuse("level " + std::to_string(twice->level) + " is named twice");
    return weights;
}

}  // namespace tessera
