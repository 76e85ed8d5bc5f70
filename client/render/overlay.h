#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tessera {

/// What is laid over the texture, to see how it is made: the borders of the pages shown, and a tint.
enum class Overlay : std::uint8_t {
    none,
    level,     ///< Borders coloured by level.
    age,       ///< How long each page has been shown.
    revision,  ///< How lately each page was edited.
};
inline constexpr std::array overlays{Overlay::none, Overlay::level, Overlay::age, Overlay::revision};

/// The word for it in options and files.
constexpr std::string_view name_of(Overlay overlay) noexcept {
    constexpr std::array<std::string_view, 4> names{"none", "level", "age", "revision"};
    return names[static_cast<std::size_t>(overlay)];
}

constexpr std::optional<Overlay> overlay_named(std::string_view name) noexcept {
    for (const Overlay overlay : overlays)
        if (name_of(overlay) == name) return overlay;
    return std::nullopt;
}

/// sRGB-coded, 0 to 1, for legends: what shading.glsl paints.
std::array<float, 3> hue_of_level(int level);
/// From new (0) to old (1).
std::array<float, 3> hue_of_age(float part);

/// Of Overlay::age: how far from new to old a page is that has been shown for so long: 0 to 1, by doublings
/// from half a second to `oldest_seconds`.
inline constexpr float oldest_seconds = 120;
/// Of Overlay::revision: 1 after so many edits of the scene, by doublings.
inline constexpr float oldest_edits = 256;

}  // namespace tessera
