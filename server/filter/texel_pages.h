#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/texture/texture.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// A page of texels as the filters read them: 256×256, rows from the top, RGBA in 65535ths of linear light,
/// premultiplied.
struct TexelPage {
    std::vector<std::uint16_t> steps;  ///< 4·256·256
    double bound_codes = 0;            ///< Of the texels themselves, rounding included.
    double confidence = 1;
};

/// Texels of every level of the infinite lattice, for filters: of a stored image, or of any texture. May be
/// asked from several threads.
class TexelPages {
  public:
    virtual ~TexelPages() = default;
    TexelPages() = default;
    TexelPages(const TexelPages&) = delete;
    TexelPages& operator=(const TexelPages&) = delete;

    /// The page with texels [256·x, 256·x + 256) × … of `level`, 0 to max_level; any signed x and y whose
    /// texels stay within ±2^41 of level 0. Errors: cancelled, timed_out.
    virtual Result<std::shared_ptr<const TexelPage>> page(std::uint8_t level, std::int64_t x, std::int64_t y,
                                                          std::int64_t slice, const Budget& budget) const = 0;
    virtual std::size_t memory_bytes() const noexcept = 0;
};

/// What lies beyond the border of a stored image.
enum class Beyond : std::uint8_t { repeat, clamp };

/// A stored image, 1 to 32768 texels a side, with its MIP levels made by the box filter; levels above the
/// image go on where it repeats, and are its edge where it clamps.
std::shared_ptr<const TexelPages> pages_of_image(const LinearImage& image, Beyond beyond);

/// Pages of a texture, evaluated when they are first asked for and kept up to `cache_bytes`.
std::shared_ptr<const TexelPages> pages_of_texture(std::shared_ptr<const Texture> texture, Accuracy accuracy,
                                                   std::size_t cache_bytes);

}  // namespace tessera
