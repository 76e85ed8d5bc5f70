#include "server/pattern/pattern_mips.h"

#include <bit>

#include "server/texture/texture.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// 1.0 in the integers that texels are summed in: linear steps times alpha codes.
constexpr double one = 65535.0 * 255.0;

/// Level 0 of all images, premultiplied, with the blank one before each slice's.
std::vector<std::uint64_t> premultiplied(const PatternImages& patterns) {
    const auto image_codes = std::size_t(patterns.side) * std::size_t(patterns.side) * 4;
    const auto images = std::size_t(patterns.slices) * (std::size_t(patterns.count) + 1);
    std::vector<std::uint64_t> texels(images * image_codes);
    std::uint64_t* texel = texels.data();
    for (std::int32_t slice = 0; slice < patterns.slices; ++slice) {
        texel += image_codes;
        for (std::int32_t pattern = 0; pattern < patterns.count; ++pattern) {
            const std::uint8_t* codes = patterns.image(pattern, slice);
            for (std::size_t i = 0; i < image_codes; i += 4, codes += 4, texel += 4) {
                const std::uint64_t alpha = codes[3];
                for (std::size_t channel = 0; channel < 3; ++channel)
                    texel[channel] = srgb_to_steps[codes[channel]] * alpha;
                texel[3] = 65535 * alpha;
            }
        }
    }
    return texels;
}

/// Sums of 2×2 texels: images of `side` texels that lie one below the other become images of half the side.
std::vector<std::uint64_t> halved(const std::vector<std::uint64_t>& texels, std::size_t side) {
    std::vector<std::uint64_t> sums(texels.size() / 4);
    const std::size_t row = side * 4, rows = texels.size() / row;
    for (std::size_t y = 0; y < rows; y += 2)
        for (std::size_t x = 0; x < side; x += 2)
            for (std::size_t channel = 0; channel < 4; ++channel) {
                const std::uint64_t* at = &texels[y * row + x * 4 + channel];
                sums[(y / 2) * (row / 2) + (x / 2) * 4 + channel] = at[0] + at[4] + at[row] + at[row + 4];
            }
    return sums;
}

}  // namespace

PatternMips::PatternMips(const PatternImages& patterns)
    : count_{patterns.count}, slices_{patterns.slices}, sum_unit_{one} {
    const int log2 = std::countr_zero(static_cast<std::uint32_t>(patterns.side));
    levels_.resize(std::size_t(log2) + 1);
    // At most 2^20 texels of 24 bits: the sums are exact
    std::vector<std::uint64_t> sums = premultiplied(patterns);
    for (int level = 0; level <= log2; ++level) {
        const std::int32_t side = patterns.side >> level;
        if (level > 0) sums = halved(sums, std::size_t(side) * 2);
        const double unit = one * static_cast<double>(std::uint64_t{1} << 2 * level);
        Level& kept = levels_[std::size_t(level)];
        kept.linear = LinearImage{side, side * images()};
        for (std::size_t i = 0; i < sums.size(); ++i)
            kept.linear.values[i] = static_cast<float>(static_cast<double>(sums[i]) / unit);
        encode(kept.linear, kept.codes);
        if (level < log2) continue;
        sum_unit_ = unit;
        sums_.resize(std::size_t(images()));
        for (std::size_t i = 0; i < sums.size(); ++i)
            sums_[i / 4][i % 4] = static_cast<std::int64_t>(sums[i]);
    }
}

std::size_t PatternMips::memory_bytes() const noexcept {
    std::size_t bytes = sizeof *this + sums_.size() * sizeof sums_[0];
    for (const Level& level : levels_)
        bytes += level.linear.values.size() * sizeof(float) + level.codes.bytes.size();
    return bytes;
}

}  // namespace tessera
