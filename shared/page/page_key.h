#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace tessera {

inline constexpr std::int32_t page_side_texels = 256;  ///< A page is 256×256 texels of one level.
inline constexpr std::int32_t max_gutter_texels =
    16;                                        ///< The widest border that a request may ask around a page.
inline constexpr std::uint8_t max_level = 30;  ///< Extents reach 256·2^30 = 2^38 texels a side.

inline constexpr std::int64_t max_slice = std::int64_t{1} << 40;  ///< Slices lie within ±max_slice.

inline constexpr std::int64_t max_step = std::int64_t{1} << 62;  ///< Requests name steps within ±max_step.

/// Where a page is in the virtual texture: a MIP level, and a cell of that level's grid of pages.
/// MIP level 0 is the finest. `x` counts pages rightwards and `y` downwards from the top-left corner.
/// A page above level 0 covers exactly four pages of the level below it.
struct PageKey {
    std::uint8_t level = 0;
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    auto operator<=>(const PageKey&) const = default;
};

/// The coarser page that covers `page`, shown while it is on its way. `page` is not on the coarsest level.
constexpr PageKey parent(PageKey page) noexcept {
    return {static_cast<std::uint8_t>(page.level + 1), page.x / 2, page.y / 2};
}

/// The virtual texture's side at level 0: 256·2^n texels, so that level n is one page.
struct Extent {
    std::uint8_t n = 20;  ///< 0 to max_level.

    constexpr std::int64_t side_texels() const noexcept { return std::int64_t{page_side_texels} << n; }
    /// Pages along one side of `level`; `level` is at most n.
    constexpr std::uint32_t side_pages(std::uint8_t level) const noexcept {
        return std::uint32_t{1} << (n - level);
    }
    constexpr bool contains(PageKey page) const noexcept {
        return page.level <= n && page.x < side_pages(page.level) && page.y < side_pages(page.level);
    }
    /// Web maps count zoom from the coarsest page: z = n − level.
    constexpr std::uint8_t zoom(std::uint8_t level) const noexcept {
        return static_cast<std::uint8_t>(n - level);
    }
    bool operator==(const Extent&) const = default;
};

struct TargetDistances;

/// A rectangle of texels of one level. `x`, `y`: its top-left texel on the infinite lattice, may be negative.
struct TexelRegion {
    std::uint8_t level = 0;
    std::int64_t x = 0;
    std::int64_t y = 0;
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::int64_t slice =
        0;  ///< Of a texture with a third dimension, in texels of level 0: levels filter x and y only.
    std::int64_t step = 0;       ///< Of the animation clock.
    std::int32_t parameter = 0;  ///< For animations that a request drives: 65536ths, 0 to 65535.
    const TargetDistances* targets = nullptr;  ///< What animations look at; null: nothing is near.
    bool operator==(const TexelRegion&) const = default;
};

/// The texels of a page with `gutter` more on each side (0 to max_gutter_texels).
constexpr TexelRegion region_of(PageKey page, std::int32_t gutter = 0) noexcept {
    return {page.level, std::int64_t{page.x} * page_side_texels - gutter,
            std::int64_t{page.y} * page_side_texels - gutter, page_side_texels + 2 * gutter,
            page_side_texels + 2 * gutter};
}

}  // namespace tessera

template <>
struct std::hash<tessera::PageKey> {
    std::size_t operator()(const tessera::PageKey& page) const noexcept {
        std::uint64_t h = (std::uint64_t{page.x} << 32 | page.y) * 0x9e3779b97f4a7c15u;
        h = (h ^ (h >> 29) ^ page.level) * 0xbf58476d1ce4e5b9u;
        return h ^ (h >> 32);
    }
};
