#include "server/filter/footprint_filter.h"

#include <charconv>
#include <utility>

namespace tessera {

namespace {

constexpr std::pair<FilterKind, std::string_view> plain_kinds[] = {
    {FilterKind::nearest, "nearest"},         {FilterKind::bilinear, "bilinear"},
    {FilterKind::trilinear, "trilinear"},     {FilterKind::ewa, "ewa"},
    {FilterKind::summed_area, "summed-area"}, {FilterKind::exact, "exact"},
};

constexpr std::string_view anisotropic = "anisotropic-", line_integral = "line-integral",
                           grid = "supersampling-grid-", jittered = "supersampling-jittered-";

/// Takes `prefix` away, if it is there.
bool take(std::string_view& name, std::string_view prefix) {
    if (!name.starts_with(prefix)) return false;
    name.remove_prefix(prefix.size());
    return true;
}

/// A number written without sign or leading zeros, and nothing after it.
std::optional<std::int32_t> number(std::string_view digits, std::int32_t least, std::int32_t most) {
    std::int32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || digits.front() == '0' ||
        value < least || value > most)
        return std::nullopt;
    return value;
}

constexpr std::int32_t most_lines = 1 << 20;

}  // namespace

std::string name_of(const FootprintFilter& filter) {
    for (const auto& [kind, name] : plain_kinds)
        if (kind == filter.kind) return std::string{name};
    const auto side = std::to_string(filter.side);
    switch (filter.kind) {
        case FilterKind::anisotropic:
            return std::string{anisotropic} + std::to_string(filter.probes);
        case FilterKind::supersampling_grid:
            return std::string{grid} + side + "x" + side;
        case FilterKind::supersampling_jittered:
            return std::string{jittered} + side + "x" + side;
        default:
            break;
    }
    std::string name{line_integral};
    if (filter.direction == LineDirection::vertical) name += "-vertical";
    if (filter.direction == LineDirection::horizontal) name += "-horizontal";
    if (filter.lines > 0) name += "-" + std::to_string(filter.lines);
    return name;
}

std::optional<FootprintFilter> filter_named(std::string_view name) {
    for (const auto& [kind, word] : plain_kinds)
        if (word == name) return FootprintFilter{.kind = kind};
    FootprintFilter filter;
    if (take(name, anisotropic)) {
        const auto probes = number(name, 1, 64);
        if (!probes) return std::nullopt;
        filter.kind = FilterKind::anisotropic;
        filter.probes = *probes;
        return filter;
    }
    if (take(name, line_integral)) {
        filter.kind = FilterKind::line_integral;
        if (take(name, "-vertical"))
            filter.direction = LineDirection::vertical;
        else if (take(name, "-horizontal"))
            filter.direction = LineDirection::horizontal;
        if (name.empty()) return filter;
        if (!take(name, "-")) return std::nullopt;
        const auto lines = number(name, 1, most_lines);
        if (!lines) return std::nullopt;
        filter.lines = *lines;
        return filter;
    }
    const bool regular = take(name, grid);
    if (!regular && !take(name, jittered)) return std::nullopt;
    const std::size_t times = name.find('x');
    if (times == std::string_view::npos || name.substr(0, times) != name.substr(times + 1))
        return std::nullopt;
    const auto side = number(name.substr(0, times), 1, 256);
    if (!side) return std::nullopt;
    filter.kind = regular ? FilterKind::supersampling_grid : FilterKind::supersampling_jittered;
    filter.side = *side;
    return filter;
}

std::vector<FootprintFilter> compared_filters() {
    std::vector<FootprintFilter> filters{{.kind = FilterKind::nearest},
                                         {.kind = FilterKind::bilinear},
                                         {.kind = FilterKind::trilinear},
                                         {.kind = FilterKind::summed_area}};
    for (const std::int32_t probes : {2, 4, 8, 16, 64})
        filters.push_back({.kind = FilterKind::anisotropic, .probes = probes});
    filters.push_back({.kind = FilterKind::ewa});
    for (const LineDirection direction :
         {LineDirection::best, LineDirection::vertical, LineDirection::horizontal})
        for (const std::int32_t lines : {4, 8, 16, 24, 48, 0})
            filters.push_back({.kind = FilterKind::line_integral, .lines = lines, .direction = direction});
    for (const std::int32_t side : {2, 4, 8, 16}) {
        filters.push_back({.kind = FilterKind::supersampling_grid, .side = side});
        filters.push_back({.kind = FilterKind::supersampling_jittered, .side = side});
    }
    filters.push_back({.kind = FilterKind::exact});
    return filters;
}

}  // namespace tessera
