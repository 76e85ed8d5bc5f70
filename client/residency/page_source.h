#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

inline constexpr std::int32_t gutter_texels = 4;  ///< Around each page in the cache.
inline constexpr std::int32_t slot_side_texels = page_side_texels + 2 * gutter_texels;  ///< 264
inline constexpr std::size_t slot_bytes = std::size_t{4} * slot_side_texels * slot_side_texels;

/// The texels of a page with its gutter: slot_bytes of RGBA, 8 bits a channel, sRGB-coded, premultiplied,
/// rows from the top; or why there are none.
struct ArrivedPage {
    PageKey page;
    Result<std::string> texels;
};

/// Where pages come from. No call waits.
class PageSource {
  public:
    virtual ~PageSource() = default;

    /// Asks for a page that is not under way already. False: the source is full; ask again later.
    virtual bool request(PageKey page) = 0;
    /// Nobody wants the page any more. It arrives with the error `cancelled`, or with its texels if those
    /// were faster.
    virtual void cancel(PageKey page) = 0;
    /// What has come since the last call, at most `most` pages. Every request arrives exactly once.
    virtual std::vector<ArrivedPage> take_arrived(std::size_t most) = 0;
};

}  // namespace tessera
