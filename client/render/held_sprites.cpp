#include "client/render/held_sprites.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr int words = 12;  ///< Of a sprite in the list
constexpr int first_layers = 8, most_spare_layers = 32;

/// The nearest half float of a value from 0 to 1.
std::uint16_t half_of(float value) {
    if (value < 6.2e-5F) return static_cast<std::uint16_t>(value * 16777216.0F + 0.5F);
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) + 0x1000;
    return static_cast<std::uint16_t>((bits >> 13) - ((127 - 15) << 10));
}

/// How far around its middle a sprite may colour a picture: half its diagonal, and as much as a footprint
/// reaches beyond a texel there, on the coarser of two levels.
double reach_of(double half_diagonal, const GroundPoint& at, const PlaneView& view) {
    const double height = view.camera().height_texels;
    const Vector3& forward = view.forward();
    double footprint = 1;
    // Largest at the far end of the sprite
    for (const double further : {0.0, half_diagonal}) {
        const double away = std::hypot(at.x, at.y);
        const double x = at.x * (1 + further / std::max(away, 1.0)),
                     y = at.y * (1 + further / std::max(away, 1.0));
        const double depth = std::max(x * forward.x + y * forward.y - height * forward.z, 1e-3 * height);
        const double fall = height / depth;
        const double longer = depth * view.pixel_step() * std::max(1.0, std::hypot(x, y) / depth / fall + 1);
        footprint = std::max(footprint, longer);
    }
    return half_diagonal + 4 * std::min(footprint, 1e9);
}

GlTexture make_texture(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return GlTexture{name};
}

}  // namespace

HeldSprites::HeldSprites() : map_{make_texture(GL_TEXTURE_2D_ARRAY)}, list_{make_texture(GL_TEXTURE_2D)} {
    glTextureStorage3D(map_.name(), 1, GL_R16UI, HeldMap::most_side, HeldMap::most_side,
                       HeldMap::most_layers);
    glTextureStorage2D(list_.name(), 1, GL_RGBA32F, words / 4, static_cast<GLsizei>(most_sprites));
}

void HeldSprites::set_pattern(std::int32_t pattern, const Rgba8Image& image, double side_texels) {
    if (image.width != image.height || image.width < 1 || image.width > 256) return;
    if (image.width != image_side_ || side_texels != side_texels_) forget_patterns();
    image_side_ = image.width;
    side_texels_ = side_texels;
    Levels& levels = levels_[pattern];
    levels.halves.clear();
    levels.layer = -1;
    std::vector<float> texels(image.bytes.size());
    for (std::size_t i = 0; i < texels.size(); i += 4) {
        const float alpha = static_cast<float>(image.bytes[i + 3]) / 255;
        for (std::size_t c = 0; c < 3; ++c)
            texels[i + c] = alpha * static_cast<float>(srgb_to_steps[image.bytes[i + c]]) / linear_one;
        texels[i + 3] = alpha;
    }
    for (auto side = static_cast<std::size_t>(image_side_);; side /= 2) {
        std::vector<std::uint16_t>& halves = levels.halves.emplace_back(texels.size());
        std::ranges::transform(texels, halves.begin(), half_of);
        if (side == 1) break;
        std::vector<float> coarser(side / 2 * (side / 2) * 4);
        for (std::size_t y = 0; y < side / 2; ++y)
            for (std::size_t x = 0; x < side / 2; ++x)
                for (std::size_t c = 0; c < 4; ++c) {
                    const float* from = &texels[(2 * y * side + 2 * x) * 4 + c];
                    coarser[(y * (side / 2) + x) * 4 + c] =
                        (from[0] + from[4] + from[side * 4] + from[side * 4 + 4]) / 4;
                }
        texels = std::move(coarser);
    }
}

void HeldSprites::forget_patterns() {
    levels_.clear();
    patterns_ = {};
    layers_ = used_layers_ = 0;
}

void HeldSprites::make_layers(int count) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    patterns_ = GlTexture{name};
    layers_ = count;
    used_layers_ = 0;
    glTextureStorage3D(name, std::bit_width(static_cast<unsigned>(image_side_)), GL_RGBA16F, image_side_,
                       image_side_, count);
    for (auto& [pattern, levels] : levels_) levels.layer = -1;
}

int HeldSprites::layer_of(std::int32_t pattern) {
    const auto found = levels_.find(pattern);
    if (found == levels_.end()) return -1;
    Levels& levels = found->second;
    if (levels.layer >= 0) return levels.layer;
    if (used_layers_ == layers_) return -1;
    levels.layer = used_layers_++;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    for (std::size_t level = 0; level < levels.halves.size(); ++level) {
        const GLsizei side = image_side_ >> level;
        glTextureSubImage3D(patterns_.name(), static_cast<GLint>(level), 0, 0, levels.layer, side, side, 1,
                            GL_RGBA, GL_HALF_FLOAT, levels.halves[level].data());
    }
    return levels.layer;
}

bool HeldSprites::prepare(std::span<const HeldSprite> sprites, const PlaneView& view) {
    undrawn_ = 0;
    std::vector<HeldReach> reaches;
    std::vector<float> list;
    std::vector<std::int32_t> used;
    for (const HeldSprite& sprite : sprites)
        if (levels_.contains(sprite.pattern)) used.push_back(sprite.pattern);
    if (used.empty()) return false;
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto missing = std::ranges::count_if(used, [&](auto one) { return levels_.at(one).layer < 0; });
    if (used_layers_ + missing > layers_) {  // those of now alone, with room for more, as animations need
        GLint most = 0;
        glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
        const int roomier = std::clamp(2 * layers_, first_layers, most_spare_layers);
        make_layers(std::min(most, std::max(roomier, 2 * static_cast<int>(used.size()))));
    }
    const double to_image = image_side_ / side_texels_;
    for (const HeldSprite& sprite : sprites) {
        const int layer = layer_of(sprite.pattern);
        if (layer < 0 || reaches.size() == most_sprites) {
            if (levels_.contains(sprite.pattern)) ++undrawn_;
            continue;
        }
        const GroundPoint at{distance_x(view.camera().ground, sprite.middle),
                             distance_y(view.camera().ground, sprite.middle)};
        const double half = side_texels_ * sprite.scale * std::numbers::sqrt2 / 2;
        reaches.push_back({at.x, at.y, reach_of(half, at, view)});
        const double angle = 2 * std::numbers::pi * sprite.turns, shrink = to_image / sprite.scale;
        for (const double word : {at.x, at.y, shrink * std::cos(angle), shrink * std::sin(angle),
                                  static_cast<double>(layer), static_cast<double>(sprite.opacity),
                                  sprite.sharp && to_image == 1 ? 1.0 : 0.0, 0.0, 0.0, 0.0, 0.0, 0.0})
            list.push_back(static_cast<float>(word));
    }
    const HeldMap map = HeldMap::of(reaches);
    undrawn_ += map.hidden;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
    glTextureSubImage3D(map_.name(), 0, 0, 0, 0, map.columns, map.rows, map.layers, GL_RED_INTEGER,
                        GL_UNSIGNED_SHORT, map.cells.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(list_.name(), 0, 0, 0, words / 4, static_cast<GLsizei>(reaches.size()), GL_RGBA,
                        GL_FLOAT, list.data());
    block_ = {{static_cast<float>(map.low_x), static_cast<float>(map.low_y)},
              static_cast<float>(map.cell),
              map.layers,
              map.columns,
              map.rows,
              static_cast<float>(image_side_),
              0};
    return map.layers > 0;
}

}  // namespace tessera
