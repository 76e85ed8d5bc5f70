#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "client/render/gl_objects.h"
#include "client/render/held_map.h"
#include "client/residency/plane_view.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// Sprites in hands as shaders/held_sprites.glsl draws them over the pages: the positioning map, what stands
/// in its cells, and the patterns with their MIP levels in linear light.
class HeldSprites {
  public:
    static constexpr std::size_t most_sprites = 1024;

    /// Needs a current context.
    HeldSprites();

    /// What a pattern looks like: sRGB-coded colour, not multiplied by alpha; a square of 1 to 256 texels a
    /// side, which stands for `side_texels` of the pattern. All of one size: another one forgets the others.
    void set_pattern(std::int32_t pattern, const Rgba8Image& image, double side_texels);
    void forget_patterns();

    /// Brings over what this view needs of these sprites, drawn in this order. Those without a pattern, and
    /// beyond most_sprites, are left out. False: nothing is to be drawn.
    bool prepare(std::span<const HeldSprite> sprites, const PlaneView& view);

    /// How many sprites the last prepare() had no room for: they are not drawn, or not everywhere.
    std::size_t undrawn() const { return undrawn_; }

    /// The uniform block `Held`, in std140.
    struct Block {
        float low[2] = {};
        float cell = 1;
        std::int32_t layers = 0;
        std::int32_t columns = 0, rows = 0;
        float side = 1;  ///< Of a pattern's image, in its own texels
        float unused = 0;
    };
    const Block& block() const { return block_; }
    GLuint map_texture() const { return map_.name(); }
    GLuint list_texture() const { return list_.name(); }
    GLuint pattern_texture() const { return patterns_.name(); }

  private:
    struct Levels {
        std::vector<std::vector<std::uint16_t>> halves;  ///< RGBA of each level, as 16-bit floats
        int layer = -1;                                  ///< Of patterns_; −1: not there
    };
    int layer_of(std::int32_t pattern);
    void make_layers(int count);

    std::map<std::int32_t, Levels> levels_;
    std::int32_t image_side_ = 0;
    double side_texels_ = 1;
    int layers_ = 0, used_layers_ = 0;
    GlTexture map_, list_, patterns_;
    std::size_t undrawn_ = 0;
    Block block_;
};

static_assert(sizeof(HeldSprites::Block) == 32);

}  // namespace tessera
