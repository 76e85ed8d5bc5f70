#pragma once

#include <string>

#include "client/render/filter.h"
#include "client/render/overlay.h"

namespace tessera {

/// So many probes lie in one page's layer, wherever their middle lies in the page: shaders/anisotropic.glsl.
/// Probes are up to two texels × n/(n + 1) apart, the gutter has 4.
inline constexpr int most_few_probes = 5;

/// One fragment shader: which picture, which texels, which filter. Software rasterisers run both sides of
/// every branch, so what a picture does not need is not in its shader.
struct ShaderVariant {
    enum class Picture { plane, surface, sky, situation };
    Picture picture = Picture::plane;
    FilterChoice filter{};
    bool whole = false;   ///< A whole texture instead of pages.
    bool fading = false;  ///< New pages fade in.
    Overlay overlay = Overlay::none;
    bool count_fetches = false;  ///< Alpha says how many texels were read.
    bool held_sprites = false;   ///< Draws what hands hold over the texture: TexelTextures::held.
    bool few_probes = false;     ///< No anisotropic footprint is longer than most_few_probes times its width.
    bool feedback = false;       ///< Says which pages were read: TexelTextures::feedback.
    auto operator<=>(const ShaderVariant&) const = default;
};

/// The source to compile behind nothing else.
std::string fragment_source(const ShaderVariant& variant);
std::string vertex_source(const ShaderVariant& variant);

}  // namespace tessera
