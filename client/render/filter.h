#pragma once

#include <array>
#include <compare>
#include <optional>
#include <string_view>

#include "client/residency/sampling.h"

namespace tessera {

/// How a pixel's colour comes from the texels of its footprint; always in linear light.
enum class Filter {
    nearest,             ///< The nearest texel of the nearest level.
    bilinear,            ///< Linear within the nearest level.
    trilinear,           ///< Linear within and between levels.
    driver_anisotropic,  ///< The driver's sampler at 16×, where it has one.
    anisotropic,    ///< The reference: 16× by the formula of EXT_texture_filter_anisotropic, in the shader.
    line_integral,  ///< Area integrals of footprints by sums along lines, both ways.
    supersample,    ///< n×n trilinear samples a pixel.
    stored,         ///< The nearest texel of the nearest level, as stored, with no haze: for tests and tools.
};

/// What people can choose, cheap first.
inline constexpr std::array filters{Filter::nearest,     Filter::bilinear,           Filter::trilinear,
                                    Filter::anisotropic, Filter::driver_anisotropic, Filter::line_integral,
                                    Filter::supersample};

/// A filter and its setting.
struct FilterChoice {
    Filter filter = Filter::trilinear;
    int subsamples = 4;  ///< Of Filter::supersample: n, 2 to max_subsamples.
    int columns = 6;     ///< Of Filter::line_integral: lines across a footprint, 2 to max_columns. Twice as
                         ///< many read four times as many pages.
    auto operator<=>(const FilterChoice&) const = default;
};

inline constexpr int max_subsamples = 16, max_columns = 32;

/// The word for it in options and reports.
constexpr std::string_view name_of(Filter filter) noexcept {
    switch (filter) {
        case Filter::nearest:
            return "nearest";
        case Filter::bilinear:
            return "bilinear";
        case Filter::trilinear:
            return "trilinear";
        case Filter::driver_anisotropic:
            return "driver-anisotropic-16";
        case Filter::anisotropic:
            return "anisotropic-16";
        case Filter::line_integral:
            return "line-integral";
        case Filter::supersample:
            return "supersample";
        case Filter::stored:
            break;
    }
    return "stored";
}

constexpr std::optional<Filter> filter_named(std::string_view name) noexcept {
    for (const Filter filter : filters)
        if (name_of(filter) == name) return filter;
    return std::nullopt;
}

/// Which pages the filter reads.
constexpr Sampling sampling_of(FilterChoice choice) noexcept {
    switch (choice.filter) {
        case Filter::nearest:
        case Filter::bilinear:
        case Filter::stored:
            return {Sampling::Kind::nearest_level};
        case Filter::anisotropic:
            return {Sampling::Kind::anisotropic};
        case Filter::driver_anisotropic:
            return {Sampling::Kind::driver_anisotropic};
        case Filter::line_integral:
            return {Sampling::Kind::line_integral, 1, choice.columns};
        case Filter::supersample:
            return {Sampling::Kind::supersampled, choice.subsamples};
        case Filter::trilinear:
            break;
    }
    return {};
}

/// Whether the current context's driver has a sampler of its own for Filter::driver_anisotropic.
bool has_driver_anisotropy();

}  // namespace tessera
