#include "client/render/surface_geometry.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace tessera {
namespace {

void send(const std::vector<float>& values, GlBuffer& buffer, std::size_t& capacity) {
    if (values.size() > capacity || capacity == 0) {
        capacity = std::max<std::size_t>(values.size() * 3 / 2, 1024);
        GLuint name = 0;
        glCreateBuffers(1, &name);
        buffer = GlBuffer{name};
        glNamedBufferStorage(name, static_cast<GLsizeiptr>(capacity * sizeof(float)), nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
    }
    if (!values.empty())
        glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(float)),
                             values.data());
}

}  // namespace

void SurfaceGeometry::upload(const std::vector<FlatPiece>& pieces) {
    corners_.clear();
    rows_.clear();
    std::int32_t index = 0;
    for (const FlatPiece& piece : pieces) {
        for (int last = 2; last < piece.corner_count; ++last) {
            for (const int corner : {0, last - 1, last}) {
                const Vector3& at = piece.corners[static_cast<std::size_t>(corner)];
                corners_.insert(corners_.end(), {static_cast<float>(at.x), static_cast<float>(at.y),
                                                 static_cast<float>(at.z), std::bit_cast<float>(index)});
            }
        }
        const std::array rows{&piece.s, &piece.t, &piece.w};
        for (std::size_t row = 0; row < rows.size(); ++row)
            rows_.insert(rows_.end(),
                         {static_cast<float>((*rows[row])[0]), static_cast<float>((*rows[row])[1]),
                          static_cast<float>((*rows[row])[2]), static_cast<float>(piece.light[row])});
        ++index;
    }
    send(corners_, corner_buffer_, corner_capacity_);
    send(rows_, row_buffer_, row_capacity_);
}

void SurfaceGeometry::draw(bool again) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, corner_buffer_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, row_buffer_.name());
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(again ? GL_GEQUAL : GL_GREATER);
    constexpr float farthest = 0;
    if (!again) glClearBufferfv(GL_DEPTH, 0, &farthest);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners_.size() / 4));
    glDisable(GL_DEPTH_TEST);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

}  // namespace tessera
