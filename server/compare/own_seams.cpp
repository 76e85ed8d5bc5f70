#include "server/compare/own_seams.h"

#include <algorithm>

#include "server/quality/lab.h"

namespace tessera {

OwnSeams measure_own_seams(const Rgb8Image& image, const std::vector<PhotoPoint>& sources, bool wraps) {
    Histogram seams{0, 300}, inside{0, 300};
    const auto index = [&](std::int32_t x, std::int32_t y) {
        return std::size_t(y) * std::size_t(image.width) + std::size_t(x);
    };
    const auto look = [&](std::size_t here, std::size_t there, std::int32_t dx, std::int32_t dy) {
        const float step = difference(image.bytes.data() + 3 * here, image.bytes.data() + 3 * there);
        const bool neighbours =
            sources[here].x + dx == sources[there].x && sources[here].y + dy == sources[there].y;
        (neighbours ? inside : seams).add(step);
    };
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x) {
            if (wraps || x + 1 < image.width) look(index(x, y), index((x + 1) % image.width, y), 1, 0);
            if (wraps || y + 1 < image.height) look(index(x, y), index(x, (y + 1) % image.height), 0, 1);
        }
    constexpr double least_step = 0.01;
    return {seams.count(),
            {seams.mean() / std::max(inside.mean(), least_step),
             seams.percentile(0.99) / std::max(inside.percentile(0.99), least_step)}};
}

}  // namespace tessera
