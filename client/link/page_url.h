#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shared/page/accuracy.h"
#include "shared/page/channel_set.h"
#include "shared/page/page_format.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// All that names a page's bytes beside its scene and key.
struct FetchOptions {
    PageFormat format = PageFormat::rgba;
    std::int32_t gutter = 0;             ///< Texels around the page, 0 to the scene's max_gutter.
    Accuracy accuracy = Accuracy::high;  ///< The server's own default, as is the next.
    ChannelSet channels = ChannelSet::albedo;
    std::int64_t step = 0;  ///< Of the animation clock.
    /// Sprites that are left out of the page, at most 64; with any, its revision is not told.
    std::vector<std::uint64_t> without{};
    bool operator==(const FetchOptions&) const = default;
};

/// `text` as one segment of a URL's path: everything but letters, digits and -._~ as %XX.
std::string percent_encoded(std::string_view text);

/// The path of a scene's TileJSON.
std::string scene_target(std::string_view scene_id);

/// The path and query of a page as it is now:
/// /scenes/{id}/{z}/{x}/{y}.{ending}?gutter=G&accuracy=…&channels=…&step=S, with what is not the default;
/// without-{sprite},{sprite} stands before {z}. `page`
/// lies in `extent`.
std::string page_target(std::string_view scene_id, Extent extent, PageKey page, const FetchOptions& options);

}  // namespace tessera
