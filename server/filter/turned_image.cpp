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
}

void TurnedImage::set_row(std::int32_t y) {
    taps_.clear();
    from_.assign(1, 0);
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
