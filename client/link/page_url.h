#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// How a page's texels are coded on the way.
enum class PageFormat : std::uint8_t { rgba, png, jpg, webp };

/// How much error a request allows (DESIGN section 3); `standard` leaves it to the server.
enum class Accuracy : std::uint8_t { standard, exact, high, fast };

/// All that names a page's bytes beside its scene and key.
struct PageOptions {
    PageFormat format = PageFormat::rgba;
    std::int32_t gutter = 0;  ///< Texels around the page, 0 to the scene's max_gutter.
    Accuracy accuracy = Accuracy::standard;
    bool operator==(const PageOptions&) const = default;
};

/// The ending of a page's path, as in "png".
std::string_view ending(PageFormat format);
/// Nothing if no format is called so.
std::optional<PageFormat> page_format(std::string_view ending);
/// "exact", "high", "fast"; empty for the server's own choice.
std::string_view name(Accuracy accuracy);

/// `text` as one segment of a URL's path: everything but letters, digits and -._~ as %XX.
std::string percent_encoded(std::string_view text);

/// The path of a scene's TileJSON.
std::string scene_target(std::string_view scene_id);

/// The path and query of a page as it is now: /scenes/{id}/{z}/{x}/{y}.{ending}?accuracy=…&gutter=G, with
/// what is not the default. `page` lies in `extent`.
std::string page_target(std::string_view scene_id, Extent extent, PageKey page, const PageOptions& options);

}  // namespace tessera
