#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/texture/exchange.h"
#include "server/texture/exchange_layout.h"
#include "server/texture/exchange_texels.h"

namespace tessera {

/// One evaluation: finds out once what is shown, and sums it for one or several images side by side.
/// exchange_pages.cpp picks the way for each level, exchange_level_0.cpp copies and blends texels,
/// exchange_level_0_codes.cpp their codes, exchange_one_texel.cpp a single one.
class ExchangeWalk {
  public:
    using TakeRow = ExchangeData::TakeRow;
    static constexpr std::size_t most_sources = 3;

    /// Of one coloured image, as the codes that pages carry; `codes` is as large as the regions to come.
    ExchangeWalk(const ExchangeLayout& layout, const ExchangeTexels& source, Rgba8Image& codes);
    /// Of one to most_sources images, as linear values. All arguments outlive the walk.
    ExchangeWalk(const ExchangeLayout& layout, std::span<const ExchangeTexels* const> sources,
                 const TakeRow& take_row);

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget) const;

  private:
    /// A block of the region: its first texel, its place in the output. Blocks bound what an evaluation holds
    /// beside its answer.
    struct Block {
        int level = 0;
        std::int64_t x = 0, y = 0;
        std::int32_t width = 0, height = 0;
        std::int32_t out_x = 0, out_y = 0;
    };
    /// Rows of sums under way, for each source: RGB, linear, with room around that whole vectors may spill
    /// to.
    class SumRows {
      public:
        static constexpr std::int32_t room = StampSpans::row_floats;

        SumRows(std::size_t sources, std::int32_t width, std::int32_t rows, std::int32_t room_left = 0,
                std::int32_t room_right = room)
            : left_{room_left},
              stride_{std::ptrdiff_t{width} * 3 + room_left + room_right},
              size_{static_cast<std::size_t>(stride_ * rows)},
              values_(sources * size_) {}
        float* row(std::size_t source, std::int32_t row) noexcept {
            return values_.data() + source * size_ + (row * stride_ + left_);
        }
        std::ptrdiff_t stride() const noexcept { return stride_; }

      private:
        std::ptrdiff_t left_, stride_;  ///< Floats.
        std::size_t size_;
        std::vector<float> values_;
    };
    class Level0Sums;
    class Level0Codes;
    /// Rows of level 0 that are blended together: few enough that their sums stay in a near cache.
    static constexpr std::int32_t level_0_rows = 16;

    Result<Evaluation> evaluate_block(const Block& block, const Budget& budget) const;
    /// A block of one texel of level 0, as a code, of typed choices.
    Result<Evaluation> one_texel(const Block&, const Budget&) const;
    /// Level 0 as linear values, or as codes.
    Result<Evaluation> blend_linear(const Block&, const Budget&) const;
    Result<Evaluation> blend_codes(const Block&, const Budget&) const;
    Result<Evaluation> sum_stamps(const Block&, const Budget&) const;
    Result<Evaluation> sum_variants(std::size_t image, const Block&, const Budget&) const;
    Result<Evaluation> look_up_nodes(const Block&, const Budget&) const;
    Result<Evaluation> enumerate_or_expect(const Block&, const Budget&) const;
    Result<Evaluation> descend_or_expect(const Block&, const Budget&) const;

    /// Hands over rows [0, count) of the sums as rows of the block from `first` on.
    void put(const Block& block, std::int32_t first, std::int32_t count, SumRows& sums) const;
    /// Rounding of floats of magnitude one, a sum for each stamp that a texel may meet, in codes of linear
    /// light.
    double float_bound_codes() const;
    bool enumerates(int height, Accuracy accuracy) const;

    const ExchangeLayout& layout_;
    const ExchangeTexels* source_list_[most_sources] = {};
    std::span<const ExchangeTexels* const> sources_;
    Rgba8Image* codes_ = nullptr;
    const TakeRow* take_row_ = nullptr;
};

}  // namespace tessera
