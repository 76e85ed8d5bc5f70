#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "client/render/gl_objects.h"
#include "client/residency/slot_cache.h"
#include "shared/result/result.h"

namespace tessera {

/// The texels of the resident pages: an array texture, one layer for each slot. sRGB-coded and premultiplied;
/// the sampler decodes before it filters.
class PageStore {
  public:
    /// `slots`: 1 to the driver's limit of layers, at least 2048.
    explicit PageStore(std::size_t slots);
    /// Error: io_failure (the driver has no room for so many).
    static Result<PageStore> make(std::size_t slots);

    /// Takes over the pages of a store of another size: each in its slot, as far as there is one, but for
    /// those that moved.
    void copy_from(const PageStore& other, std::span<const SlotCache::Move> moves);

    /// `texels`: slot_bytes, as in SlotUpload.
    void upload(Slot slot, std::string_view texels);

    /// Decoded to linear light when sampled.
    GLuint texture() const { return texture_.name(); }
    /// The same texels as stored codes, 0 to 1, undecoded.
    GLuint coded_texture() const { return coded_view_.name(); }
    std::size_t bytes() const;

  private:
    std::size_t slots_;
    GlTexture texture_;
    GlTexture coded_view_;
};

}  // namespace tessera
