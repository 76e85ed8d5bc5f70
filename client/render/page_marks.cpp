#include "client/render/page_marks.h"

#include <algorithm>
#include <cmath>

#include "client/render/overlay.h"

namespace tessera {

float mark_of(std::uint64_t page_revision, std::uint64_t newest_revision) {
    if (page_revision == 0) return -1;
    const std::uint64_t since = newest_revision - std::min(newest_revision, page_revision);
    return std::min(std::log2(1 + static_cast<float>(since)) / std::log2(1 + oldest_edits), 1.0F);
}

void PageMarks::update(const Residency& residency) {
    const std::size_t slots = residency.slots();
    if (slots != marks_.size()) {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &name);
        texture_ = GlTexture{name};
        glTextureStorage2D(name, 1, GL_R32F, static_cast<GLsizei>(slots), 1);
    }
    marks_.assign(slots, -1);
    std::uint64_t newest = 0;
    for (const auto& [page, slot] : residency.cache().pages())
        if (const PageVersion* held = residency.versions().held(page))
            newest = std::max(newest, held->scene_revision);
    for (const auto& [page, slot] : residency.cache().pages())
        if (const PageVersion* held = residency.versions().held(page))
            marks_[slot] = mark_of(held->revision, newest);
    glTextureSubImage2D(texture_.name(), 0, 0, 0, static_cast<GLsizei>(slots), 1, GL_RED, GL_FLOAT,
                        marks_.data());
}

}  // namespace tessera
