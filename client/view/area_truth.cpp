#include "client/view/area_truth.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

using Triple = std::array<double, 3>;

std::int64_t wrapped(std::int64_t value, std::int64_t side) { return value & (side - 1); }

}  // namespace

AreaTruth::AreaTruth(const Rgba8Image& image) : side_{image.width} {
    const auto length = static_cast<std::size_t>(side_) + 1;
    for (const bool upright : {true, false}) {
        std::vector<Sums>& sums = sums_[upright ? 0 : 1];
        sums.resize(length * static_cast<std::size_t>(side_));
        for (std::int32_t at = 0; at < side_; ++at) {
            Sums* line = sums.data() + length * static_cast<std::size_t>(at);
            for (std::int32_t i = 0; i < side_; ++i) {
                const std::uint8_t* texel = upright ? image.row(i) + 4 * at : image.row(at) + 4 * i;
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::uint32_t steps = srgb_to_steps[texel[c]];
                    line[i + 1].sum[c] = line[i].sum[c] + steps;
                    line[i + 1].integral[c] = line[i].integral[c] + line[i].sum[c] + steps / 2.0;
                }
            }
        }
    }
}

const AreaTruth::Sums* AreaTruth::line(bool upright, std::int64_t index) const {
    return sums_[upright ? 0 : 1].data() +
           (static_cast<std::size_t>(side_) + 1) * static_cast<std::size_t>(wrapped(index, side_));
}

/// The running sum at y ≥ 0, which may be many repeats on.
Triple AreaTruth::sum_at(const Sums* line, double y) const {
    const double repeats = std::floor(y / side_), within = y - repeats * side_;
    const auto whole = std::min(static_cast<std::int32_t>(within), side_ - 1);
    Triple sum;
    for (std::size_t c = 0; c < 3; ++c)
        sum[c] = repeats * line[side_].sum[c] + line[whole].sum[c] +
                 (within - whole) * (line[whole + 1].sum[c] - line[whole].sum[c]);
    return sum;
}

Triple AreaTruth::integral_at(const Sums* line, double y) const {
    const double repeats = std::floor(y / side_), within = y - repeats * side_;
    const auto whole = std::min(static_cast<std::int32_t>(within), side_ - 1);
    const double part = within - whole;
    Triple integral;
    for (std::size_t c = 0; c < 3; ++c) {
        const double total = line[side_].sum[c], texel = line[whole + 1].sum[c] - line[whole].sum[c];
        integral[c] = repeats * line[side_].integral[c] + total * side_ * repeats * (repeats - 1) / 2 +
                      repeats * total * within + line[whole].integral[c] + part * line[whole].sum[c] +
                      part * part / 2 * texel;
    }
    return integral;
}

/// Adds ∫ sum dx where the outline goes from y0 to y1 across `width` of one line, signed.
void AreaTruth::add_crossing(const Sums* line, double y0, double y1, double width, Triple& integral) const {
    if (std::abs(y1 - y0) > 1) {
        const Triple from = integral_at(line, y0), to = integral_at(line, y1);
        for (std::size_t c = 0; c < 3; ++c) integral[c] += width * (to[c] - from[c]) / (y1 - y0);
        return;
    }
    // At most one border between texels, and the sum is linear on either side
    const double border = std::floor(std::max(y0, y1));
    const double share = border > std::min(y0, y1) ? (border - y0) / (y1 - y0) : 1;
    const Triple first = sum_at(line, share < 1 ? (y0 + border) / 2 : (y0 + y1) / 2);
    for (std::size_t c = 0; c < 3; ++c) integral[c] += width * share * first[c];
    if (share >= 1) return;
    const Triple second = sum_at(line, (border + y1) / 2);
    for (std::size_t c = 0; c < 3; ++c) integral[c] += width * (1 - share) * second[c];
}

Triple AreaTruth::mean(const Footprint& footprint) const {
    const auto& corners = footprint.corners;
    const auto [left, right] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
    const auto [top, bottom] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
    const bool upright = right - left <= bottom - top;  // along y where that crosses fewer lines

    // Whole repeats aside, so that sums stay small
    const std::int64_t along = wrapped(upright ? footprint.y : footprint.x, side_);
    const std::int64_t across = upright ? footprint.x : footprint.y;
    const double lowest = upright ? top : left;
    const double shift =
        static_cast<double>(along) - std::floor((lowest + static_cast<double>(along)) / side_) * side_;
    Triple integral{};
    double area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const TexelPoint a = corners[i], b = corners[(i + 1) % 4];
        double x0 = upright ? a.x : a.y, y0 = (upright ? a.y : a.x) + shift;
        double x1 = upright ? b.x : b.y, y1 = (upright ? b.y : b.x) + shift;
        if (x0 == x1) continue;
        const double sign = x0 < x1 ? 1 : -1;
        if (sign < 0) {
            std::swap(x0, x1);
            std::swap(y0, y1);
        }
        area += sign * (x1 - x0) * (y0 + y1) / 2;
        const double slope = (y1 - y0) / (x1 - x0);
        for (double column = std::floor(x0); column < x1; ++column) {
            const double from = std::max(column, x0), to = std::min(column + 1, x1);
            if (to <= from) continue;
            const auto clamped = [&](double x) {
                return std::clamp(y0 + (x - x0) * slope, std::min(y0, y1), std::max(y0, y1));
            };
            add_crossing(line(upright, across + static_cast<std::int64_t>(column)), clamped(from),
                         clamped(to), sign * (to - from), integral);
        }
    }
    for (double& channel : integral) channel /= area * 65535;
    return integral;
}

TruePicture true_picture(const Situation& situation, const AreaTruth& texture) {
    const auto pixels =
        static_cast<std::size_t>(situation.width) * static_cast<std::size_t>(situation.height);
    TruePicture picture{{situation.width, situation.height},
                        std::vector<float>(3 * pixels),
                        std::vector<std::uint8_t>(pixels)};
    const auto some_rows = [&](std::int32_t first, std::int32_t step) {
        for (std::int32_t y = first; y < situation.height; y += step) {
            for (std::int32_t x = 0; x < situation.width; ++x) {
                const auto footprint = footprint_of(situation, x, y);
                if (!footprint || !(area_of(*footprint) > 0)) continue;
                const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(situation.width) +
                                static_cast<std::size_t>(x);
                picture.measured[at] = 1;
                const Triple colour = texture.mean(*footprint);
                for (std::size_t c = 0; c < 3; ++c) {
                    picture.linear[3 * at + c] = static_cast<float>(colour[c]);
                    picture.codes.codes[3 * at + c] = static_cast<float>(fractional_srgb_code(colour[c]));
                }
            }
        }
    };
    const auto threads = static_cast<std::int32_t>(std::clamp(std::thread::hardware_concurrency(), 1U, 64U));
    std::vector<std::jthread> helpers;
    for (std::int32_t i = 0; i < threads; ++i) helpers.emplace_back(some_rows, i, threads);
    helpers.clear();
    return picture;
}

}  // namespace tessera
