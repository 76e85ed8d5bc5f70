#include "server/filter/turned_image.h"

#include <algorithm>
#include <array>

namespace tessera {

TurnedImage::TurnedImage(const ImagePlacement& placement)
    : placement_{placement}, footprints_{placement.side, placement.side} {
    const Turning t = turning(placement.turns);
    cosine_ = t.cosine / placement.scale;
    sine_ = t.sine / placement.scale;
    // The corner of the first texel, in the image
    const double x = 0.5 * placement.side - cosine_ * placement.middle_x - sine_ * placement.middle_y;
    const double y = 0.5 * placement.side + sine_ * placement.middle_x - cosine_ * placement.middle_y;
    const auto whole = [](double v) { return v == static_cast<double>(static_cast<std::int64_t>(v)); };
    onto_texels_ = placement.scale == 1 && (t.cosine == 0 || t.sine == 0) && whole(x) && whole(y);
    // Where doubles hold all of it, products of weights are the parallelograms' integrals to the last bit
    constexpr double parts = 4096;
    const bool is_exact =
        whole(cosine_ * parts) && whole(sine_ * parts) && whole(x * parts) && whole(y * parts);
    if (!onto_texels_ && is_exact && (t.cosine == 0 || t.sine == 0)) cut_axes();
}

/// The integral of the surface along one axis (parallelogram.h): from [i + 0.5, i + 1.5] on it goes from one
/// texel to the next.
TurnedImage::Stretch TurnedImage::stretch(double from, double to) {
    if (from > to) std::swap(from, to);
    const double side = placement_.side, least = std::max(from, 0.0) - 0.5, most = std::min(to, side) - 0.5;
    Stretch found{0, axis_weights_.size(), axis_weights_.size()};
    if (!(least < most)) return found;
    const auto floor_of = [](double v) { return static_cast<std::int32_t>(v + 1) - 1; };  // v >= −1
    found.first = std::max(floor_of(least), 0);
    const std::int32_t last = std::min(floor_of(most) + 1, placement_.side - 1);
    axis_weights_.resize(found.from + static_cast<std::size_t>(last - found.first + 1));
    const auto at = [&](std::int32_t i) -> double& {
        return axis_weights_[found.from +
                             static_cast<std::size_t>(std::clamp(i, 0, placement_.side - 1) - found.first)];
    };
    for (std::int32_t i = floor_of(least); i < most; ++i) {
        const double a = std::max(least, static_cast<double>(i)) - i, b = std::min(most - i, 1.0);
        const double towards = (b - a) * (b + a) / 2;
        at(i) += b - a - towards;
        at(i + 1) += towards;
    }
    found.to = axis_weights_.size();
    return found;
}

void TurnedImage::cut_axes() {
    const double c = cosine_, s = sine_, middle = 0.5 * placement_.side;
    for (std::int32_t i = 0; i < placement_.width; ++i) {
        const double x = i - placement_.middle_x, y = i - placement_.middle_y;
        // A quarter turn exchanges the axes: then the result's columns are rows of the image
        columns_.push_back(s == 0 ? stretch(middle + c * x, middle + c * x + c)
                                  : stretch(middle - s * x, middle - s * x - s));
        rows_.push_back(s == 0 ? stretch(middle + c * y, middle + c * y + c)
                               : stretch(middle + s * y, middle + s * y + s));
    }
}

void TurnedImage::set_straight_row(std::int32_t y) {
    const double area = placement_.scale * placement_.scale;
    const Stretch& down = rows_[static_cast<std::size_t>(y)];
    for (const Stretch& across : columns_) {
        const Stretch &rows = sine_ == 0 ? down : across, &columns = sine_ == 0 ? across : down;
        for (std::size_t j = rows.from; j < rows.to; ++j)
            for (std::size_t i = columns.from; i < columns.to; ++i) {
                const double weight = axis_weights_[j] * axis_weights_[i];
                if (weight > 0)
                    taps_.push_back(
                        {(rows.first + static_cast<std::int32_t>(j - rows.from)) * placement_.side +
                             columns.first + static_cast<std::int32_t>(i - columns.from),
                         weight * area});
            }
        from_.push_back(taps_.size());
    }
}

void TurnedImage::set_row(std::int32_t y) {
    taps_.clear();
    from_.assign(1, 0);
    if (!columns_.empty()) return set_straight_row(y);
    const double c = cosine_, s = sine_, size = placement_.scale, side = placement_.side;
    for (std::int32_t x = 0; x < placement_.width; ++x) {
        const double from_x = x - placement_.middle_x, from_y = y - placement_.middle_y;
        const Parallelogram footprint{.x = 0.5 * side + c * from_x + s * from_y,
                                      .y = 0.5 * side - s * from_x + c * from_y,
                                      .along_x = c,
                                      .along_y = -s,
                                      .across_x = s,
                                      .across_y = c};
        if (onto_texels_) {
            // Its middle, which no rounding can push into the next texel
            const double i = footprint.x + 0.5 * (c + s), j = footprint.y + 0.5 * (c - s);
            if (i > 0 && j > 0 && i < side && j < side)
                taps_.push_back(
                    {static_cast<std::int32_t>(j) * placement_.side + static_cast<std::int32_t>(i), 1.0});
        } else {
            for (const Tap& tap : footprints_.of(footprint))
                taps_.push_back({tap.texel, tap.weight * (size * size)});
        }
        from_.push_back(taps_.size());
    }
}

void TurnedImage::sum(const std::uint16_t* image, std::uint16_t* out) const noexcept {
    for (std::size_t x = 0; x + 1 < from_.size(); ++x) {
        std::array<double, 4> sum{0.5, 0.5, 0.5, 0.5};
        for (std::size_t k = from_[x]; k < from_[x + 1]; ++k) {
            const std::uint16_t* texel = image + static_cast<std::size_t>(taps_[k].texel) * 4;
            for (std::size_t c = 0; c < 4; ++c) sum[c] += taps_[k].weight * texel[c];
        }
        for (std::size_t c = 0; c < 4; ++c)
            out[x * 4 + c] = static_cast<std::uint16_t>(std::min(sum[c], 65535.0));
    }
}

}  // namespace tessera
