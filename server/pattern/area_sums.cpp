#include "server/pattern/area_sums.h"

#include <algorithm>

namespace tessera {

AreaSums::Stretch AreaSums::stretch(const Axis& axis, std::int64_t from, std::int64_t to) noexcept {
    Stretch stretch;
    const auto add = [&](std::int64_t first, std::int64_t last, std::int64_t times) {
        if (first < last && times > 0)
            stretch.parts[static_cast<std::size_t>(stretch.count++)] = {static_cast<std::int32_t>(first),
                                                                        static_cast<std::int32_t>(last),
                                                                        static_cast<double>(times)};
    };
    from -= axis.from;
    to -= axis.from;
    if (axis.wraps) {
        const std::int64_t periods = (to - from) / axis.count, rest = (to - from) % axis.count;
        const std::int64_t first = (from % axis.count + axis.count) % axis.count;
        add(0, axis.count, periods);
        add(first, std::min(first + rest, axis.count), 1);
        add(0, first + rest - axis.count, 1);
    } else {
        add(0, 1, std::min<std::int64_t>(to, 0) - from);
        add(std::clamp<std::int64_t>(from, 0, axis.count), std::clamp<std::int64_t>(to, 0, axis.count), 1);
        add(axis.count - 1, axis.count, to - std::max(from, axis.count));
    }
    return stretch;
}

Colour AreaSums::sum(const Stretch& columns, const Stretch& rows) const noexcept {
    Colour sum{};
    for (std::int32_t r = 0; r < rows.count; ++r) {
        const auto& row = rows.parts[static_cast<std::size_t>(r)];
        for (std::int32_t k = 0; k < columns.count; ++k) {
            const auto& column = columns.parts[static_cast<std::size_t>(k)];
            const auto& bottom_right = sums_[index(column.to, row.to)];
            const auto& bottom_left = sums_[index(column.from, row.to)];
            const auto& top_right = sums_[index(column.to, row.from)];
            const auto& top_left = sums_[index(column.from, row.from)];
            const double times = column.times * row.times;
            for (std::size_t c = 0; c < 4; ++c)
                sum[c] += times *
                          static_cast<double>(bottom_right[c] - bottom_left[c] - top_right[c] + top_left[c]);
        }
    }
    for (double& channel : sum) channel *= unit;
    return sum;
}

}  // namespace tessera
