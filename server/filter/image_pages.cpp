#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "server/filter/image_axis.h"
#include "server/filter/page_cache.h"
#include "server/filter/texel_pages.h"
#include "shared/math/srgb.h"

namespace tessera {

namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::size_t image_cache_bytes = std::size_t{256} << 20;

/// Texel (x, y) of level l is the average of the 2^l × 2^l texels of level 0 under it, of the lattice that
/// the repeated or clamped image makes, whatever the image's size: where a side is not a multiple of 2^l, a
/// texel that meets the border averages what lies on both sides of it. Sums are exact integers, rounded once.
/// Sums of less than a block of up to 8×8 texels are made when they are asked for; those above come from a
/// summed-area table of blocks. Where an image repeats, blocks are no larger than its sides are multiples of:
/// larger ones would be no fewer. The table then takes up to 32 bytes a texel.
class ImagePages final : public TexelPages {
  public:
    ImagePages(const LinearImage& image, Beyond beyond)
        : width_{image.width},
          block_level_{
              beyond == Beyond::clamp
                  ? 3
                  : std::min(3, std::countr_zero(static_cast<std::uint32_t>(image.width | image.height)))},
          across_{image.width, beyond, block_level_},
          down_{image.height, beyond, block_level_},
          steps_(image.values.size()),
          cache_{image_cache_bytes} {
        double furthest = 0;
        for (std::size_t i = 0; i < steps_.size(); ++i) {
            steps_[i] = to_steps(image.values[i]);
            furthest = std::max(
                furthest, std::fabs(static_cast<double>(image.values[i]) - steps_[i] / double{linear_one}));
        }
        texel_bound_codes_ = furthest / code_in_linear;
        sum_blocks();
    }

    Result<std::shared_ptr<const TexelPage>> page(std::uint8_t level, std::int64_t x, std::int64_t y,
                                                  std::int64_t, const Budget& budget) const override {
        x = across_.same_page(level, x);
        y = down_.same_page(level, y);
        return cache_.get({x, y, 0, level}, budget, [&]() -> TexelPageCache::Made {
            if (const auto within = check_budget(budget); !within) return within.error();
            auto page = std::make_shared<TexelPage>();
            page->steps.resize(std::size_t{4} * page_side_texels * page_side_texels);
            page->bound_codes = texel_bound_codes_ + (level == 0 ? 0 : 0.5 / 65535.0 / code_in_linear);
            if (level == 0 || level < block_level_)
                sum_texels(level, x * page_side_texels, y * page_side_texels, page->steps.data());
            else
                look_up(level, x * page_side_texels, y * page_side_texels, page->steps.data());
            return page;
        });
    }

    std::size_t memory_bytes() const noexcept override {
        return steps_.size() * sizeof steps_[0] + table_.size() * sizeof table_[0] + cache_.memory_bytes();
    }

  private:
    struct Line {
        const std::uint16_t* texels;
        const std::uint16_t* texel(std::int64_t at) const noexcept { return texels + 4 * at; }
    };
    Line line(std::int64_t y) const noexcept {
        return {steps_.data() +
                static_cast<std::size_t>(down_.texel(y)) * 4 * static_cast<std::size_t>(width_)};
    }

    /// Entries above and left of describing block (x, y): 4 channels.
    const std::uint64_t* entry(std::int64_t x, std::int64_t y) const noexcept {
        return table_.data() + 4 * static_cast<std::size_t>(y * (across_.blocks() + 1) + x);
    }

    void sum_blocks() {
        const std::int64_t side = std::int64_t{1} << block_level_;
        const std::int64_t wide = across_.blocks() + 1, high = down_.blocks() + 1;
        table_.assign(4 * static_cast<std::size_t>(wide * high), 0);
        std::vector<std::int64_t> columns;
        for (std::int64_t i = 0; i < across_.blocks() * side; ++i)
            columns.push_back(across_.texel(across_.first_block() * side + i));
        for (std::int64_t by = 0; by < down_.blocks(); ++by) {
            std::uint64_t* out = table_.data() + 4 * static_cast<std::size_t>((by + 1) * wide + 1);
            const std::uint64_t* above = out - 4 * wide;
            std::array<std::uint64_t, 4> sum{};
            for (std::int64_t bx = 0; bx < across_.blocks(); ++bx, out += 4, above += 4) {
                for (std::int64_t j = 0; j < side; ++j) {
                    const Line from = line((down_.first_block() + by) * side + j);
                    for (std::int64_t i = 0; i < side; ++i)
                        for (std::size_t c = 0; c < 4; ++c)
                            sum[c] += from.texel(columns[static_cast<std::size_t>(bx * side + i)])[c];
                }
                for (std::size_t c = 0; c < 4; ++c) out[c] = above[c] + sum[c];
            }
        }
    }

    void sum_texels(int level, std::int64_t x, std::int64_t y, std::uint16_t* out) const {
        const std::int64_t side = std::int64_t{1} << level;
        std::vector<std::int64_t> columns;
        for (std::int64_t i = 0; i < page_side_texels * side; ++i)
            columns.push_back(across_.texel(x * side + i));
        const std::uint32_t half = level == 0 ? 0u : 1u << (2 * level - 1);
        for (std::int64_t row = 0; row < page_side_texels; ++row)
            for (std::int64_t column = 0; column < page_side_texels; ++column, out += 4) {
                std::array<std::uint32_t, 4> sum{half, half, half, half};
                for (std::int64_t j = 0; j < side; ++j) {
                    const Line from = line((y + row) * side + j);
                    for (std::int64_t i = 0; i < side; ++i)
                        for (std::size_t c = 0; c < 4; ++c)
                            sum[c] += from.texel(columns[static_cast<std::size_t>(column * side + i)])[c];
                }
                for (std::size_t c = 0; c < 4; ++c) out[c] = static_cast<std::uint16_t>(sum[c] >> 2 * level);
            }
    }

    void look_up(int level, std::int64_t x, std::int64_t y, std::uint16_t* out) const {
        const int shift = level - block_level_;
        std::vector<std::array<ImageAxis::Piece, 3>> columns;
        for (std::int64_t i = 0; i < page_side_texels; ++i)
            columns.push_back(across_.pieces((x + i) * (std::int64_t{1} << shift),
                                             (x + i + 1) * (std::int64_t{1} << shift)));
        for (std::int64_t row = 0; row < page_side_texels; ++row) {
            const auto rows = down_.pieces((y + row) * (std::int64_t{1} << shift),
                                           (y + row + 1) * (std::int64_t{1} << shift));
            for (const auto& column : columns) {
                const Wide half = Wide{1} << (2 * level - 1);
                std::array<Wide, 4> sum{half, half, half, half};
                for (const ImageAxis::Piece& v : rows) {
                    if (v.times == 0 || v.from == v.to) continue;
                    for (const ImageAxis::Piece& u : column) {
                        if (u.times == 0 || u.from == u.to) continue;
                        const std::uint64_t *a = entry(u.from, v.from), *b = entry(u.to, v.from),
                                            *c = entry(u.from, v.to), *d = entry(u.to, v.to);
                        const Wide times = static_cast<Wide>(u.times) * static_cast<Wide>(v.times);
                        for (std::size_t k = 0; k < 4; ++k) sum[k] += times * (d[k] - c[k] - (b[k] - a[k]));
                    }
                }
                for (std::size_t k = 0; k < 4; ++k) *out++ = static_cast<std::uint16_t>(sum[k] >> 2 * level);
            }
        }
    }

    std::int32_t width_;
    int block_level_;
    ImageAxis across_, down_;
    std::vector<std::uint16_t> steps_;  ///< RGBA of the image, rows from the top.
    std::vector<std::uint64_t> table_;  ///< Of describing blocks; a row and a column of zeros first.
    double texel_bound_codes_ = 0;
    mutable TexelPageCache cache_;
};

}  // namespace

std::shared_ptr<const TexelPages> pages_of_image(const LinearImage& image, Beyond beyond) {
    return std::make_shared<ImagePages>(image, beyond);
}

}  // namespace tessera
