#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tessera {

/// What a page shows of a surface (DESIGN section 6, `channels`). All sets of a scene share its decisions: a
/// texel of each is the same place of the same exemplar.
enum class ChannelSet : std::uint8_t {
    albedo,     ///< Colour, sRGB-coded: every scene has it, and it is the default.
    normal,     ///< Data: the unit normal of the mean slopes, n·0.5 + 0.5; x to the right, y up (OpenGL), z
                ///< outwards.
    roughness,  ///< Data, grey: perceptual roughness (α = roughness²), with the bumps that filtering took
                ///< away.
    height,     ///< Data, grey.
    moments,  ///< Data: how the slopes spread under a texel: σx, σy (1 and more is 1), correlation·0.5 + 0.5.
};

inline constexpr std::array channel_sets{ChannelSet::albedo, ChannelSet::normal, ChannelSet::roughness,
                                         ChannelSet::height, ChannelSet::moments};

/// The word for it in addresses, options and headers.
constexpr std::string_view name_of(ChannelSet set) noexcept {
    switch (set) {
        case ChannelSet::albedo:
            return "albedo";
        case ChannelSet::normal:
            return "normal";
        case ChannelSet::roughness:
            return "roughness";
        case ChannelSet::height:
            return "height";
        case ChannelSet::moments:
            break;
    }
    return "moments";
}

constexpr std::optional<ChannelSet> channel_set_named(std::string_view name) noexcept {
    for (const ChannelSet set : channel_sets)
        if (name_of(set) == name) return set;
    return std::nullopt;
}

}  // namespace tessera
