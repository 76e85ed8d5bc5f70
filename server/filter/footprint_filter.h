#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

/// The ways to average a footprint. The truth that all of them aim at is the law of pages: a texel is a
/// square of one colour, and a footprint's colour is the area integral over it, in linear light,
/// premultiplied.
enum class FilterKind : std::uint8_t {
    nearest,             ///< One texel of level 0.
    bilinear,            ///< Four texels of level 0.
    trilinear,           ///< Isotropic MIP (Williams 1983).
    anisotropic,         ///< Probes along the major axis (EXT_texture_filter_anisotropic).
    ewa,                 ///< Elliptical weighted average (Greene and Heckbert 1986).
    summed_area,         ///< The footprint's bounding box (Crow 1984).
    line_integral,       ///< Columns, or rows, of sums (line-integral-textures, section 3).
    supersampling_grid,  ///< side² points of level 0 on a grid over the footprint, more where they differ.
    supersampling_jittered,  ///< The same, each point anywhere in its stratum, repeatably.
    exact,                   ///< The area integral of the clipped quadrilateral.
};

/// The direction in which line integrals run.
enum class LineDirection : std::uint8_t {
    vertical,    ///< Sums along columns, as in the paper.
    horizontal,  ///< Sums along rows.
    best,        ///< Whichever walks over fewer lines of this footprint (section 4.3).
};

/// A filter with its setting: one point of the plot of error against time.
struct FootprintFilter {
    FilterKind kind = FilterKind::exact;
    std::int32_t probes = 16;  ///< anisotropic: at most so many, 1 to 64.
    std::int32_t side = 8;     ///< supersampling: side² samples at first, 1 to 256.
    std::int32_t lines =
        0;  ///< line_integral: at most so many columns or rows, then a coarser level; 0: any number.
    LineDirection direction = LineDirection::best;
    bool operator==(const FootprintFilter&) const = default;
};

/// "nearest", "anisotropic-16", "line-integral-vertical-24", "supersampling-jittered-8x8", …: what requests,
/// reports and options call a filter. Round trip with filter_named().
std::string name_of(const FootprintFilter& filter);
std::optional<FootprintFilter> filter_named(std::string_view name);

/// Every kind at every setting that a report compares, cheapest kinds first.
std::vector<FootprintFilter> compared_filters();

/// What a filter says of one footprint.
struct FilteredSample {
    std::array<float, 4> color{};  ///< RGBA, linear, premultiplied.
    /// No channel is further from the footprint's true average, in 8-bit codes of linear light (the source's
    /// own bound included).
    double bound_codes = 0;
    double confidence = 1;     ///< 1: the bound is certain; less: it holds with this probability.
    std::uint64_t texels = 0;  ///< Texels, or entries of tables, that were fetched.
};

}  // namespace tessera
