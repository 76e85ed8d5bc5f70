#include "server/filter/image_axis.h"

#include <algorithm>
#include <numeric>

namespace tessera {

namespace {

std::int64_t floor_mod(std::int64_t a, std::int64_t period) noexcept {
    const std::int64_t rest = a % period;
    return rest < 0 ? rest + period : rest;
}

}  // namespace

ImageAxis::ImageAxis(std::int32_t texels, Beyond beyond, int block_level) noexcept
    : texels_{texels}, blocks_{0}, beyond_{beyond} {
    const std::int64_t side = std::int64_t{1} << block_level;
    blocks_ = beyond == Beyond::repeat ? texels / std::gcd(texels_, side) : (texels + side - 1) / side + 2;
}

std::int64_t ImageAxis::texel(std::int64_t at) const noexcept {
    return beyond_ == Beyond::repeat ? floor_mod(at, texels_) : std::clamp<std::int64_t>(at, 0, texels_ - 1);
}

std::array<ImageAxis::Piece, 3> ImageAxis::pieces(std::int64_t from, std::int64_t to) const noexcept {
    if (beyond_ == Beyond::repeat) {
        const std::int64_t first = floor_mod(from, blocks_), whole = (to - from) / blocks_,
                           last = first + (to - from) % blocks_;
        return {{{first, std::min(last, blocks_), 1},
                 {0, std::max<std::int64_t>(last - blocks_, 0), 1},
                 {0, blocks_, whole}}};
    }
    // Blocks before the image are all like block −1, those beyond it like the first one there
    const std::int64_t beyond = blocks_ - 2, count = to - from;
    return {{{std::clamp<std::int64_t>(from, 0, beyond) + 1, std::clamp<std::int64_t>(to, 0, beyond) + 1, 1},
             {0, 1, std::clamp<std::int64_t>(-from, 0, count)},
             {beyond + 1, beyond + 2, std::clamp<std::int64_t>(to - beyond, 0, count)}}};
}

std::int64_t ImageAxis::same_page(std::uint8_t level, std::int64_t page) const noexcept {
    if (beyond_ == Beyond::repeat) {
        const std::int64_t texels = texels_ / std::gcd(texels_, std::int64_t{1} << level);
        return floor_mod(page, texels / std::gcd(texels, std::int64_t{page_side_texels}));
    }
    const int shift = level + 8;
    return std::clamp<std::int64_t>(page, -1, ((texels_ - 1) >> shift) + 1);
}

}  // namespace tessera
