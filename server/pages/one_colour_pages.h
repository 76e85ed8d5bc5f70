#pragma once

#include <list>
#include <memory>
#include <mutex>

#include "server/pages/page_encoder.h"

namespace tessera {

/// The last few one-colour pages, encoded: a scene's sky or sea is encoded once, and its pages share the
/// bytes. May be called from any thread.
class OneColourPages {
  public:
    /// The body of `image`, whose texels all have one colour.
    Result<std::shared_ptr<const EncodedBytes>> encode(const Rgba8Image& image, TexelKind kind,
                                                       PageFormat format, ContentCoding coding);

  private:
    struct Known {
        std::uint32_t color = 0;
        std::int32_t width = 0, height = 0;
        PageFormat format{};
        ContentCoding coding{};
        TexelKind kind{};
        bool operator==(const Known&) const = default;
    };
    struct Body {
        Known key;
        std::shared_ptr<const EncodedBytes> bytes;
    };
    static constexpr std::size_t kept = 16;

    std::mutex mutex_;
    std::list<Body> bodies_;  ///< The last used first.
};

/// encode_page() and, with `coding` zstd, compress_zstd().
Result<EncodedBytes> encode_body(const Rgba8Image& image, TexelKind kind, PageFormat format,
                                 ContentCoding coding);

}  // namespace tessera
