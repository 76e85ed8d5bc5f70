#pragma once

#include <set>
#include <vector>

#include "client/residency/needed_pages.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera::testing {

/// The pages that the pixels of a frame read.
class Feedback {
  public:
    Feedback(Extent extent, int window_side) : extent_{extent}, side_{window_side} {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
        texture_ = GlTexture{name};
        glTextureStorage3D(name, 1, GL_R32UI, side_, side_, extent.n + 1);
    }

    std::set<PageKey> of(Offscreen& offscreen, const Camera& camera, FilterChoice filter) {
        const std::uint32_t none = 0;
        glClearTexImage(texture_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
        offscreen.draw(camera, {.filter = filter, .feedback = true}, texture_.name());
        glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
        std::vector<std::uint32_t> read(static_cast<std::size_t>(side_ * side_ * (extent_.n + 1)));
        glGetTextureImage(texture_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                          static_cast<GLsizei>(read.size() * sizeof read[0]), read.data());
        std::set<PageKey> pages;
        for (int l = 0; l <= extent_.n; ++l) {
            const auto level = static_cast<std::uint8_t>(l);
            const PageKey centre = offscreen.scene->residency().table().centre_page(level);
            const auto coordinate = [&](std::uint32_t middle, int at) {
                const std::int64_t first = std::int64_t{middle} - side_ / 2;
                return static_cast<std::uint32_t>(first + ((at - first) & (side_ - 1)));
            };
            for (int y = 0; y < side_; ++y)
                for (int x = 0; x < side_; ++x)
                    if (read[static_cast<std::size_t>((l * side_ + y) * side_ + x)] != 0)
                        pages.insert({level, coordinate(centre.x, x), coordinate(centre.y, y)});
        }
        return pages;
    }

  private:
    Extent extent_;
    int side_;
    GlTexture texture_;
};

}  // namespace tessera::testing
