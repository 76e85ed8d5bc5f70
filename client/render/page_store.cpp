#include "client/render/page_store.h"

#include <algorithm>
#include <string>

#include "client/residency/page_source.h"

namespace tessera {

PageStore::PageStore(std::size_t slots) : slots_{slots} {
    const auto layers = static_cast<GLsizei>(slots);
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    texture_ = GlTexture{name};
    glTextureStorage3D(name, 1, GL_SRGB8_ALPHA8, slot_side_texels, slot_side_texels, layers);
    glGenTextures(1, &name);  // a view's name must be unused
    coded_view_ = GlTexture{name};
    glTextureView(name, GL_TEXTURE_2D_ARRAY, texture_.name(), GL_RGBA8, 0, 1, 0, static_cast<GLuint>(layers));
}

Result<PageStore> PageStore::make(std::size_t slots) {
    while (glGetError() != GL_NO_ERROR) {
    }
    PageStore made{slots};
    if (glGetError() != GL_NO_ERROR)
        return Error{ErrorCode::io_failure, "the driver has no room for a cache of " + std::to_string(slots) +
                                                " pages: choose a smaller one"};
    return made;
}

void PageStore::copy_from(const PageStore& other, std::span<const SlotCache::Move> moves) {
    const auto copy = [&](std::size_t from, std::size_t to, std::size_t layers) {
        glCopyImageSubData(other.texture_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(from),
                           texture_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(to),
                           slot_side_texels, slot_side_texels, static_cast<GLsizei>(layers));
    };
    copy(0, 0, std::min(slots_, other.slots_));
    for (const SlotCache::Move& move : moves) copy(move.from, move.to, 1);
}

void PageStore::upload(Slot slot, std::string_view texels) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage3D(texture_.name(), 0, 0, 0, slot, slot_side_texels, slot_side_texels, 1, GL_RGBA,
                        GL_UNSIGNED_BYTE, texels.data());
}

std::size_t PageStore::bytes() const { return slots_ * slot_bytes; }

}  // namespace tessera
