#include "client/render/page_table_texture.h"

namespace tessera {

static_assert(sizeof(TableEntry) == 16, "an entry is one RGBA32UI texel");

PageTableTexture::PageTableTexture(Extent extent, int window_side) : window_side_{window_side} {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    texture_ = GlTexture{name};
    glTextureStorage3D(name, 1, GL_RGBA32UI, window_side, window_side, extent.n + 1);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void PageTableTexture::update(PageTable& table) {
    for (const std::uint8_t level : table.take_changed_levels())
        glTextureSubImage3D(texture_.name(), 0, 0, 0, level, window_side_, window_side_, 1, GL_RGBA_INTEGER,
                            GL_UNSIGNED_INT, table.entries(level).data());
}

}  // namespace tessera
