#include "client/view/viewer_state.h"

#include <algorithm>
#include <cmath>

namespace tessera {

Surface surface_after(const Surface& surface, int steps, const Camera& camera) {
    constexpr std::array kinds{Surface::Kind::plane, Surface::Kind::terrain, Surface::Kind::corridor};
    const auto at = static_cast<int>(std::ranges::find(kinds, surface.kind) - kinds.begin());
    Surface next = surface;
    next.kind = kinds[static_cast<std::size_t>((at + steps % 3 + 3) % 3)];
    return around(next, camera);
}

Filter filter_after(Filter filter, int steps, bool has_driver_anisotropy) {
    constexpr auto count = static_cast<int>(filters.size());
    auto at = static_cast<int>(std::ranges::find(filters, filter) - filters.begin());
    do at = (at + steps % count + count) % count;
    while (filters[static_cast<std::size_t>(at)] == Filter::driver_anisotropic && !has_driver_anisotropy);
    return filters[static_cast<std::size_t>(at)];
}

void switch_split(ViewerSwitches& switches) {
    if (switches.split) {
        switches.split.reset();
        return;
    }
    switches.split = SplitChoice{.filter = switches.filter};
    switches.split->filter.filter =
        switches.filter.filter == Filter::line_integral ? Filter::trilinear : Filter::line_integral;
}

const char* title_of(Filter filter) {
    switch (filter) {
        case Filter::nearest:
            return "nearest texel";
        case Filter::bilinear:
            return "bilinear";
        case Filter::trilinear:
            return "trilinear";
        case Filter::driver_anisotropic:
            return "16x anisotropic, the driver's";
        case Filter::anisotropic:
            return "16x anisotropic, by the formula";
        case Filter::line_integral:
            return "line integral";
        case Filter::supersample:
            return "supersampling";
        case Filter::stored:
            break;
    }
    return "texels as stored";
}

std::optional<CursorReading> read_cursor(const PlaneView& view, const Residency& residency, double lod_bias,
                                         double x, double y) {
    if (x < 0 || y < 0 || x >= view.width() || y >= view.height()) return std::nullopt;
    const auto ground = view.ground_at(x, y);
    const Extent extent = residency.extent();
    const auto side = static_cast<double>(extent.side_texels());
    if (!ground || std::abs(ground->x) > side || std::abs(ground->y) > side) return std::nullopt;
    CursorReading reading;
    reading.texel = view.camera().ground.moved(ground->x, ground->y);
    const PlanePoint& at = reading.texel;
    if (at.x < 0 || at.y < 0 || at.x >= extent.side_texels() || at.y >= extent.side_texels())
        return std::nullopt;
    reading.level = std::clamp(view.level_at(x, y) + lod_bias, 0.0, static_cast<double>(extent.n));
    const auto level = static_cast<std::uint8_t>(std::floor(reading.level + 0.5));
    reading.page = {level, static_cast<std::uint32_t>(at.x >> (8 + level)),
                    static_cast<std::uint32_t>(at.y >> (8 + level))};
    reading.shown = residency.table().shown_for(reading.page);
    if (reading.shown) {
        PageKey page = reading.page;
        while (page.level < reading.shown->level) page = parent(page);
        if (const PageVersion* held = residency.versions().held(page)) reading.version = *held;
    }
    reading.under_way = residency.requests().is_under_way(reading.page);
    return reading;
}

std::string page_state(const CursorReading& reading) {
    const char* coming = reading.under_way ? ", on its way" : "";
    if (!reading.shown) return std::string{"nothing yet"} + coming;
    const int missing = reading.shown->level - reading.page.level;
    if (missing == 0) return "sharp";
    return std::to_string(missing) + (missing == 1 ? " level coarser" : " levels coarser") + coming;
}

}  // namespace tessera
