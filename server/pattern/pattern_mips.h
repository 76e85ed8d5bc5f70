#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/blocks/pattern_images.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// The MIP chains of a pattern set: each image (pattern and slice) by itself, so that nothing bleeds in from
/// the pattern packed beside it. Every level is the exact box reduction of level 0, in linear light and
/// premultiplied; its codes, as pages carry them, are kept too, so that a page of cells is copies of rows.
class PatternMips {
  public:
    explicit PatternMips(const PatternImages& patterns);

    int side_log2() const noexcept { return static_cast<int>(levels_.size()) - 1; }
    std::int32_t slices() const noexcept { return slices_; }
    std::int32_t count() const noexcept { return count_; }

    /// Images are kept slice by slice: a blank one, then the patterns. So an image's index is its pattern's,
    /// −1 for the blank one, from first_image(slice) on.
    std::int32_t images() const noexcept { return slices_ * (count_ + 1); }
    std::int32_t first_image(std::int32_t slice) const noexcept { return slice * (count_ + 1) + 1; }
    /// A pattern's slice; a blank image where there is none (pattern −1, slice outside).
    std::int32_t image(std::int32_t pattern, std::int64_t slice) const noexcept {
        if (pattern < 0 || pattern >= count_ || slice < 0 || slice >= slices_) return 0;
        return first_image(static_cast<std::int32_t>(slice)) + pattern;
    }

    /// All images of a level: image i is its rows i·side to (i + 1)·side − 1, where side is the pattern's,
    /// halved `level` times (0 to side_log2()).
    const LinearImage& linear(int level) const noexcept { return levels_[std::size_t(level)].linear; }
    const Rgba8Image& codes(int level) const noexcept { return levels_[std::size_t(level)].codes; }

    /// The sum of an image's texels, linear and premultiplied, in integers of which sum_unit() are a mean of
    /// 1: below 2^45, so that cells are summed without rounding.
    const std::array<std::int64_t, 4>& sum(std::int32_t image) const noexcept {
        return sums_[std::size_t(image)];
    }
    double sum_unit() const noexcept { return sum_unit_; }
    /// The image's mean colour.
    std::array<double, 4> mean(std::int32_t image) const noexcept {
        const auto& of = sum(image);
        return {static_cast<double>(of[0]) / sum_unit_, static_cast<double>(of[1]) / sum_unit_,
                static_cast<double>(of[2]) / sum_unit_, static_cast<double>(of[3]) / sum_unit_};
    }

    std::size_t memory_bytes() const noexcept;

  private:
    struct Level {
        LinearImage linear;
        Rgba8Image codes;
    };
    std::int32_t count_;
    std::int32_t slices_;
    std::vector<Level> levels_;
    std::vector<std::array<std::int64_t, 4>> sums_;
    double sum_unit_;
};

}  // namespace tessera
