#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// How a page's texels are coded on the way.
enum class FetchFormat : std::uint8_t { rgba, png, jpg, webp };

/// How much error a request allows (DESIGN section 3).
enum class FetchAccuracy : std::uint8_t { exact, high, fast };

/// All that names a page's bytes beside its scene and key.
struct FetchOptions {
    FetchFormat format = FetchFormat::rgba;
    std::int32_t gutter = 0;                       ///< Texels around the page, 0 to the scene's max_gutter.
    FetchAccuracy accuracy = FetchAccuracy::high;  ///< The server's own default.
    bool operator==(const FetchOptions&) const = default;
};

/// The ending of a page's path, as in "png".
std::string_view ending(FetchFormat format);
/// Nothing if no format is called so.
std::optional<FetchFormat> fetch_format(std::string_view ending);
/// "exact", "high" or "fast".
std::string_view name_of(FetchAccuracy accuracy);

/// `text` as one segment of a URL's path: everything but letters, digits and -._~ as %XX.
std::string percent_encoded(std::string_view text);

/// The path of a scene's TileJSON.
std::string scene_target(std::string_view scene_id);

/// The path and query of a page as it is now: /scenes/{id}/{z}/{x}/{y}.{ending}?gutter=G&accuracy=…, with
/// what is not the default. `page` lies in `extent`.
std::string page_target(std::string_view scene_id, Extent extent, PageKey page, const FetchOptions& options);

}  // namespace tessera
