#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "client/render/gl_objects.h"
#include "shared/result/result.h"

namespace tessera {

/// The running sums of pages' lines that Filter::line_integral reads (shaders/line_integral.glsl): an integer
/// array texture, two layers for each page, 2 MiB a page. Computed on the GPU from the pages' codes.
class IntegralStore {
  public:
    static constexpr std::int32_t side_texels = 256;
    static constexpr std::size_t page_bytes = std::size_t{2} * 16 * side_texels * side_texels;

    /// Needs a current context. `pages`: at most 1024. Error: io_failure with the driver's words.
    static Result<std::unique_ptr<IntegralStore>> make(std::size_t pages);

    /// Sums up these layers of an array texture of stored codes (RGBA8), whose pages begin `gutter` texels
    /// in.
    void build(GLuint coded_pages, int gutter, std::span<const int> layers);

    GLuint texture() const { return texture_.name(); }
    std::size_t bytes() const { return pages_ * page_bytes; }

  private:
    IntegralStore(std::size_t pages, GlProgram program);

    std::size_t pages_;
    GlProgram program_;
    GlTexture texture_;
    GlBuffer steps_;
};

}  // namespace tessera
