#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace tessera {

/// Filters that are one method at several settings: drawn in one colour, in the plot and on the page.
struct FilterFamily {
    std::string_view prefix;  ///< Of the filters' names.
    std::string_view title;
    std::array<std::uint8_t, 3> color;
};

inline constexpr std::array<FilterFamily, 11> filter_families{{
    {"nearest", "nearest", {138, 138, 138}},
    {"bilinear", "bilinear", {92, 92, 92}},
    {"trilinear", "trilinear", {140, 106, 66}},
    {"anisotropic", "anisotropic probes", {31, 111, 139}},
    {"ewa", "EWA", {122, 79, 168}},
    {"summed-area", "summed-area table", {192, 137, 26}},
    {"line-integral-vertical", "line integral, vertical", {240, 136, 106}},
    {"line-integral-horizontal", "line integral, horizontal", {232, 158, 168}},
    {"line-integral", "line integral, best of two", {214, 48, 49}},
    {"supersampling", "supersampling", {46, 139, 87}},
    {"exact", "exact", {20, 20, 20}},
}};

/// The first family whose prefix the name has; none of them: the last but grey.
constexpr const FilterFamily& family_of(std::string_view filter) noexcept {
    for (const FilterFamily& family : filter_families)
        if (filter.starts_with(family.prefix)) return family;
    return filter_families.front();
}

}  // namespace tessera
