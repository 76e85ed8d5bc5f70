#include "client/render/whole_texture.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "shared/math/srgb.h"

namespace tessera {

std::vector<Rgba8Image> averaged_levels(const Rgba8Image& image) {
    // Sums of level 0's 16-bit steps, exact: 2^22 texels of 2^16 steps
    const auto texels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    std::vector<std::uint64_t> sums(4 * texels);
    for (std::size_t at = 0; at < sums.size(); ++at)
        sums[at] = at % 4 == 3 ? 257U * image.bytes[at] : srgb_to_steps[image.bytes[at]];
    const auto& codes = steps_to_srgb();
    std::vector<Rgba8Image> levels{image};
    for (std::int32_t side = image.width / 2, level = 1; side >= 1; side /= 2, ++level) {
        std::vector<std::uint64_t> next(4 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
        const auto row = 8 * static_cast<std::size_t>(side);
        Rgba8Image picture{side, side};
        const std::uint64_t count = std::uint64_t{1} << (2 * level);
        for (std::size_t at = 0; at < next.size(); ++at) {
            const std::size_t y = at / (row / 2), x = at % (row / 2) / 4, channel = at % 4;
            const std::size_t from = 2 * y * row + 8 * x + channel;
            next[at] = sums[from] + sums[from + 4] + sums[from + row] + sums[from + row + 4];
            const std::uint64_t mean = (next[at] + count / 2) / count;
            picture.bytes[at] = channel == 3 ? static_cast<std::uint8_t>((mean + 128) / 257) : codes[mean];
        }
        levels.push_back(std::move(picture));
        sums = std::move(next);
    }
    return levels;
}

WholeTexture::WholeTexture(std::vector<Rgba8Image> levels)
    : side_log2_{std::countr_zero(static_cast<unsigned>(levels.front().width))} {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    texture_ = GlTexture{name};
    glTextureStorage2D(name, static_cast<GLsizei>(levels.size()), GL_SRGB8_ALPHA8, levels.front().width,
                       levels.front().width);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    for (std::size_t level = 0; level < levels.size(); ++level)
        glTextureSubImage2D(name, static_cast<GLint>(level), 0, 0, levels[level].width, levels[level].height,
                            GL_RGBA, GL_UNSIGNED_BYTE, levels[level].bytes.data());
    levels_ = std::move(levels);
}

/// Layers of 256 × 256 texels, in the order that whole.glsl counts them; a smaller level repeats in its own.
Result<void> WholeTexture::bring_integrals() {
    if (integrals_) return {};
    const auto pages_a_side = [](const Rgba8Image& level) {
        return std::max(level.width / page_side_texels, 1);
    };
    std::size_t pages = 0;
    for (const Rgba8Image& level : levels_) {
        const auto across = static_cast<std::size_t>(pages_a_side(level));
        pages += across * across;
    }
    auto made = IntegralStore::make(pages);
    if (!made) return made.error();
    integrals_ = std::move(made.value());
    std::string texels(std::size_t{4} * page_side_texels * page_side_texels, '\0');
    int page = 0;
    for (const Rgba8Image& level : levels_) {
        const int across = pages_a_side(level);
        for (int at = 0; at < across * across; ++at, ++page) {
            auto* texel = reinterpret_cast<std::uint8_t*>(texels.data());
            for (int y = 0; y < page_side_texels; ++y) {
                const std::uint8_t* row = level.row((at / across * page_side_texels + y) % level.height);
                for (int x = 0; x < page_side_texels; ++x, texel += 4)
                    std::copy_n(row + 4 * ((at % across * page_side_texels + x) % level.width), 4, texel);
            }
            integrals_->upload(page, texels, 0);
        }
    }
    return {};
}

}  // namespace tessera
