#include "server/scene/opening_view.h"

#include <algorithm>
#include <sstream>

#include "proto/opening_view.pb.h"

namespace tessera {
namespace {

Result<std::int64_t> inside(const char* field, std::int64_t texel, Extent extent) {
    if (texel >= 0 && texel < extent.side_texels()) return texel;
    return Error{ErrorCode::invalid_input, std::string{field} + ": is " + std::to_string(texel) +
                                               "; texels of this scene are 0 to " +
                                               std::to_string(extent.side_texels() - 1)};
}

}  // namespace

Result<OpeningView> opening_view_of(const proto::OpeningView& message, Extent extent) {
    const std::int64_t middle = extent.side_texels() / 2;
    const auto x = inside("view.x", message.has_x() ? message.x() : middle, extent);
    if (!x) return x.error();
    const auto y = inside("view.y", message.has_y() ? message.y() : middle, extent);
    if (!y) return y.error();
    const double level = message.has_level() ? message.level() : std::min<double>(1, extent.n);
    if (!(level >= min_view_level && level <= extent.n)) {
        std::ostringstream text;
        text << "view.level: is " << level << "; levels of this scene are " << min_view_level << " to "
             << int{extent.n};
        return Error{ErrorCode::invalid_input, text.str()};
    }
    return OpeningView{*x, *y, level};
}

}  // namespace tessera
