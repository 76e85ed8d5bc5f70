#include "server/pattern/periodic_sums.h"

#include <algorithm>
#include <bit>
#include <map>

namespace tessera {
std::shared_ptr<const PeriodicSums> PeriodicSums::make(const CellProgram& program, const PatternMips& mips,
                                                       std::int32_t slice, std::int64_t z) {
    const auto period = static_cast<std::size_t>(program.period());
    const std::shared_ptr<PeriodicSums> made{
        new PeriodicSums{std::countr_zero(static_cast<std::uint64_t>(program.period()))}};
    made->unit_ = mips.sum_unit();
    std::map<std::vector<std::int32_t>, std::size_t> known;
    std::vector<std::int32_t> cells(period);
    for (std::size_t y = 0; y < period; ++y) {
        program.patterns(
            {.y = static_cast<std::int64_t>(y), .count = static_cast<std::int32_t>(period), .z = z},
            cells.data());
        const auto [row, is_new] = known.try_emplace(cells, known.size());
        if (is_new) {
            if (known.size() * period > most_cells) return nullptr;
            std::vector<std::array<std::int64_t, 4>> sums(period + 1);
            for (std::size_t x = 0; x < period; ++x)
                for (std::size_t c = 0; c < 4; ++c)
                    sums[x + 1][c] = sums[x][c] + mips.sum(mips.image(cells[x], slice))[c];
            made->sums_.push_back(std::move(sums));
            made->counts_.emplace_back(period + 1, 0);
        }
        ++made->counts_[row->second][y + 1];
    }
    for (auto& counts : made->counts_)
        for (std::size_t y = 0; y < period; ++y) counts[y + 1] += counts[y];
    return made;
}

Colour PeriodicSums::mean(std::int64_t x, std::int64_t y, int up) const noexcept {
    // Both powers of two: a square lies inside one period, or is a whole number of them
    const int side_log2 = std::min(up, period_log2_);
    const std::int64_t side = std::int64_t{1} << side_log2, mask = (std::int64_t{1} << period_log2_) - 1;
    const auto left = static_cast<std::size_t>((x << up) & mask),
               top = static_cast<std::size_t>((y << up) & mask);
    const auto right = left + static_cast<std::size_t>(side), bottom = top + static_cast<std::size_t>(side);
    Colour mean{};
    for (std::size_t row = 0; row < sums_.size(); ++row) {
        const double count = counts_[row][bottom] - counts_[row][top];
        for (std::size_t c = 0; c < 4; ++c)
            mean[c] += count * static_cast<double>(sums_[row][right][c] - sums_[row][left][c]);
    }
    const double unit = unit_ * static_cast<double>(side) * static_cast<double>(side);
    for (double& channel : mean) channel /= unit;
    return mean;
}

}  // namespace tessera
