#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "client/render/gl_objects.h"
#include "shared/result/result.h"

namespace tessera {

/// The running sums of pages' lines that Filter::line_integral reads (shaders/line_integral.glsl tells their
/// form): an integer array texture, two layers for each page, 2 MiB a page.
class IntegralStore {
  public:
    static constexpr std::int32_t side_texels = 256;
    static constexpr std::size_t page_bytes = std::size_t{2} * 16 * side_texels * side_texels;

    /// Needs a current context. `pages`: at most half as many as the driver has layers. Error: io_failure
    /// with what to do.
    static Result<std::unique_ptr<IntegralStore>> make(std::size_t pages);

    /// Sums up a page and brings it to the GPU. `texels`: RGBA codes of (side_texels + 2·gutter)² texels.
    void upload(int page, std::string_view texels, int gutter);

    /// The same for a page that is on the GPU already, as a layer of an array texture of codes (RGBA8). Waits
    /// for the GPU.
    void upload_from(GLuint coded_pages, int gutter, int layer, int page);

    /// All pages of a smaller one, at the same places.
    void copy_from(const IntegralStore& other);

    GLuint texture() const { return texture_.name(); }
    std::size_t bytes() const { return pages_ * page_bytes; }

  private:
    explicit IntegralStore(std::size_t pages);

    std::size_t pages_;
    GlTexture texture_;
    std::vector<std::uint32_t> words_;  ///< Of one page: along y, then along x
};

}  // namespace tessera
