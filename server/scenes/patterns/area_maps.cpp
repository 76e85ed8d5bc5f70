#include "server/scenes/patterns/area_maps.h"

#include <cmath>

#include "server/scenes/noise.h"

namespace tessera::painting {

std::vector<std::uint8_t> paint_shore_map(std::int32_t side) {
    std::vector<std::uint8_t> map;
    for (std::int32_t j = 0; j < side; ++j)
        for (std::int32_t i = 0; i < side; ++i) {
            const double u = (i + 0.5) / side, v = (j + 0.5) / side;
            // Bays, and a path that winds between them
            const double bay = fractal_noise(u * 4, v * 4, 2001, 3, 4);
            const double path = std::abs(fractal_noise(u * 3, v * 3, 2002, 2, 3));
            map.push_back(bay > 0.14 || path < 0.055 ? 1 : 0);
        }
    return map;
}

std::vector<std::uint8_t> paint_leaf_map(std::int32_t side) {
    std::vector<std::uint8_t> map;
    for (std::int32_t j = 0; j < side; ++j)
        for (std::int32_t i = 0; i < side; ++i) {
            const double u = (i + 0.5) / side, v = (j + 0.5) / side;
            const double near = fractal_noise(u * 6, v * 6, 2101, 2, 6);  // to a tree
            const double kind = fractal_noise(u * 5, v * 5, 2102, 2, 5);
            std::uint8_t area = 0;
            if (near > -0.08) area = kind < -0.12 ? 1 : kind < 0.14 ? 2 : 3;
            if (near > 0.34) area = 4;
            map.push_back(area);
        }
    return map;
}

}  // namespace tessera::painting
