#include "client/render/page_table_texture.h"

#include <bit>

namespace tessera {
namespace {

static_assert(sizeof(TableEntry) == 16, "an entry is one RGBA32UI texel");

GlTexture make_levels(GLenum format, int window_side, Extent extent) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    glTextureStorage3D(name, 1, format, window_side, window_side, extent.n + 1);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return GlTexture{name};
}

}  // namespace

PageTableTexture::PageTableTexture(Extent extent, int window_side)
    : window_side_{window_side},
      texture_{make_levels(GL_RGBA8, window_side, extent)},
      entries_{make_levels(GL_RGBA32UI, window_side, extent)} {}

int PageTableTexture::update(PageTable& table) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    const int wrapped_bits = std::countr_zero(static_cast<unsigned>(window_side_));
    const auto byte = [](std::int64_t value) { return static_cast<std::uint8_t>(value & 255); };
    const std::vector<std::uint8_t> changed = table.take_changed_levels();
    for (const std::uint8_t level : changed) {
        bytes_.clear();
        for (const TableEntry& entry : table.entries(level)) {
            const int tag_x = (entry.page_x >> wrapped_bits) & 15,
                      tag_y = (entry.page_y >> wrapped_bits) & 15;
            bytes_.insert(bytes_.end(), {byte(entry.shown), byte(entry.shown >> 8), byte(entry.shown >> 16),
                                         byte(tag_x | tag_y << 4)});
        }
        glTextureSubImage3D(texture_.name(), 0, 0, 0, level, window_side_, window_side_, 1, GL_RGBA,
                            GL_UNSIGNED_BYTE, bytes_.data());
        glTextureSubImage3D(entries_.name(), 0, 0, 0, level, window_side_, window_side_, 1, GL_RGBA_INTEGER,
                            GL_UNSIGNED_INT, table.entries(level).data());
    }
    return changed.empty() ? -1 : changed.front();
}

}  // namespace tessera
