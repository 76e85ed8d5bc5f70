#include "server/pattern/cell_texture.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "server/blocks/kernels.h"
#include "server/pattern/cell_rows.h"
#include "server/pattern/cell_slice.h"
#include "server/pattern/epoch_expectation.h"
#include "server/pattern/pattern_mips.h"
#include "server/pattern/periodic_sums.h"
#include "server/pattern/pixel_format.h"
#include "server/pattern/scroll_watch.h"
#include "server/pattern/slice_cache.h"
#include "server/pattern/typed_texture.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// Rounding to float, the only error of levels that are exact.
constexpr double rounding_codes = 4e-5;

/// Texels of up to 4^this cells are summed cell by cell. It depends on nothing else, so that neighbouring
/// regions agree.
constexpr int enumerated_levels(Accuracy accuracy) {
    return accuracy == Accuracy::exact ? 4 : accuracy == Accuracy::high ? 3 : 0;
}
/// And exact on, up to here, as long as the expectation would be off by more than half a code: a page of such
/// texels takes about two seconds.
constexpr int most_enumerated_levels = 7;
constexpr int most_nested_levels = 6;  ///< Nested thresholds take longer, …
constexpr int most_moving_levels = 5;  ///< … and animations, at each step anew.
constexpr double half_a_code = 0.5;

/// Cells of a row that are summed at a time.
constexpr std::int64_t summed_cells = 1024;

/// Where nothing is known of larger texels' cells, 4^this of them are looked at.
constexpr int sampled_levels(Accuracy accuracy) {
    return accuracy == Accuracy::exact ? 4 : accuracy == Accuracy::high ? 3 : 2;
}

/// Cells that are drawn one by one, or from one map.
class DrawnCells final : public PatternTexture {
  public:
    DrawnCells(const ReferencePlan& plan, std::shared_ptr<const PatternMips> mips)
        : grid_{plan.grid}, program_{plan.program}, mips_{std::move(mips)} {
        means_.slices = mips_->slices();
        for (std::int32_t pattern = 0; pattern < mips_->count(); ++pattern)
            for (std::int32_t slice = 0; slice < mips_->slices(); ++slice)
                means_.means.push_back(mips_->mean(mips_->image(pattern, slice)));
        ColourRange range;
        range.add(Colour{});
        for (const auto& mean : means_.means) range.add(mean);
        width_ = range.width();
        expectation_.emplace(program_, means_, width_);
        const auto varying = program_->varying();
        const int most = program_->moves()            ? most_moving_levels
                         : varying && varying->nested ? most_nested_levels
                                                      : most_enumerated_levels;
        const bool is_known = expectation_->known() && !expectation_->certain();
        while (is_known && exact_levels_ < most && expectation_->bound(exact_levels_ + 1).codes > half_a_code)
            ++exact_levels_;
        if (is_known && exact_levels_ == most_enumerated_levels) {
            const double codes = expectation_->bound(exact_levels_ + 1).codes;
            quarters_ = codes > half_a_code && codes * quarter_of_draws + quarter_slack <= half_a_code;
        }
    }

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        return evaluate(region, budget, budget.accuracy == Accuracy::exact, out);
    }
    Result<Evaluation> evaluate_part(const TexelRegion& region, const Budget& budget,
                                     LinearImage& out) const override {
        return evaluate(region, budget, false, out);
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        const CellSlice at = cell_slice(grid_, region.slice, mips_->slices());
        if (at.slice < mips_->slices() && region.level <= grid_.cell_log2) {
            reshape(out, region.width, region.height);
            return copy(region, at, budget, out);
        }
        const int up = region.level - grid_.cell_log2;
        if (at.slice < mips_->slices() &&
            by_expectation(up, budget.accuracy, budget.accuracy == Accuracy::exact) &&
            expectation_->uniform())
            return fill(region, budget, out);
        return Texture::evaluate(region, budget, out);
    }
    std::string_view kind() const noexcept override { return "pattern"; }
    std::string description() const override {
        return std::to_string(mips_->count()) + " patterns, cells of " +
               std::to_string(std::int64_t{1} << grid_.cell_log2) + " texels, above them " +
               (expectation_->certain() ? "exact"
                : expectation_->known() ? "cells, then their expectation"
                : has_period()          ? "sums of their periods"
                                        : "cells, then a sample of them");
    }
    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + mips_->memory_bytes() + means_.memory_bytes() + program_->memory_bytes() +
               expectation_->memory_bytes() + (has_period() ? PeriodicSums::most_bytes : 0);
    }
    int cell_level() const noexcept override { return expectation_->certain() ? -1 : grid_.cell_log2; }

  private:
    /// `deep`: half a code matters more than time.
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget, bool deep,
                                LinearImage& out) const {
        reshape(out, region.width, region.height);
        const CellSlice at = cell_slice(grid_, region.slice, mips_->slices());
        if (at.slice >= mips_->slices()) return blank(out);
        if (region.level <= grid_.cell_log2) return copy(region, at, budget, out);
        const int up = region.level - grid_.cell_log2;
        if (by_quarters(up, deep)) return sum_quarters(region, at, budget, out);
        if (by_expectation(up, budget.accuracy, deep))
            return expectation_->evaluate(region, at.slice, up, budget, out);
        if (const auto periods = periods_of(at)) return sum_periods(*periods, region, up, budget, out);
        if (expectation_->known() || up <= sampled_levels(budget.accuracy))
            return sum_cells(region, at, budget, out);
        return sample_cells(region, at, budget, out);
    }
    bool has_period() const noexcept {
        const std::int64_t period = program_->period();
        return !expectation_->known() && period > 0 && period <= PeriodicSums::most_period;
    }
    /// Null where cells do not repeat, or are expected.
    std::shared_ptr<const PeriodicSums> periods_of(const CellSlice& at) const {
        if (!has_period()) return nullptr;
        return periods_
            .get(at.z * mips_->slices() + at.slice,
                 [&](std::int64_t) {
                     return std::make_shared<const Periods>(Periods{
                         PeriodicSums::make(*program_, *mips_, static_cast<std::int32_t>(at.slice), at.z)});
                 })
            ->sums;
    }
    static Result<Evaluation> sum_periods(const PeriodicSums& periods, const TexelRegion& region, int up,
                                          const Budget& budget, LinearImage& out) {
        for (std::int32_t y = 0; y < region.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            float* texel = out.row(y);
            for (std::int32_t x = 0; x < region.width; ++x)
                for (const double channel : periods.mean(region.x + x, region.y + y, up))
                    *texel++ = static_cast<float>(channel);
        }
        return Evaluation{
            .method = "periods",
            .bound_codes = rounding_codes,
            .work = std::uint64_t(region.width) * std::uint64_t(region.height) * periods.rows()};
    }

    bool by_quarters(int up, bool deep) const noexcept {
        return quarters_ && deep && up == exact_levels_ + 1;
    }
    bool by_expectation(int up, Accuracy accuracy, bool deep) const noexcept {
        const int summed = deep ? exact_levels_ : enumerated_levels(accuracy);
        return expectation_->certain() || (expectation_->known() && up > summed && !by_quarters(up, deep));
    }

    /// A quarter of each texel's cells are summed, and the others expected. What is still drawn has three
    /// quarters of the variance, and of the draws' squares; the slack is for what of a bound does not shrink
    /// with the root of the number of cells: one draw's reach, and the corner inside an L of cells.
    static constexpr double quarter_of_draws = 0.8660254037844387, quarter_slack = 0.005;
    Result<Evaluation> sum_quarters(const TexelRegion& region, const CellSlice& at, const Budget& budget,
                                    LinearImage& out) const {
        const int up = region.level - grid_.cell_log2;
        const auto whole = expectation_->evaluate(region, at.slice, up, budget, out);
        if (!whole) return whole;
        // The upper left quarter of each texel
        TexelRegion finer = region;
        finer.level = static_cast<std::uint8_t>(region.level - 1);
        finer.width = finer.height = 1;
        LinearImage drawn{1, 1}, expected{1, 1};
        std::uint64_t work = whole->work;
        Validity validity = whole->validity;
        for (std::int32_t y = 0; y < region.height; ++y)
            for (std::int32_t x = 0; x < region.width; ++x) {
                finer.x = 2 * (region.x + x);
                finer.y = 2 * (region.y + y);
                const auto summed = sum_cells(finer, at, budget, drawn);
                if (!summed) return summed;
                const auto mean = expectation_->evaluate(finer, at.slice, up - 1, budget, expected);
                if (!mean) return mean;
                work += summed->work;
                validity.meet(summed->validity);
                validity.meet(mean->validity);
                for (std::size_t c = 0; c < 4; ++c)
                    out.row(y)[4 * x + static_cast<std::int32_t>(c)] +=
                        0.25F * (drawn.values[c] - expected.values[c]);
            }
        return Evaluation{
            .method = "cells in part",
            .bound_codes = (whole->bound_codes - rounding_codes) * quarter_of_draws + quarter_slack,
            .confidence = whole->confidence,
            .work = work,
            .validity = validity};
    }

    /// One colour, coded once.
    Result<Evaluation> fill(const TexelRegion& region, const Budget& budget, Rgba8Image& out) const {
        TexelRegion texel = region;
        texel.width = texel.height = 1;
        const auto evaluation = Texture::evaluate(texel, budget, out);
        if (!evaluation) return evaluation;
        const std::array<std::uint8_t, 4> code{out.bytes[0], out.bytes[1], out.bytes[2], out.bytes[3]};
        reshape(out, region.width, region.height);
        for (std::size_t i = 0; i < out.bytes.size(); i += 4) std::memcpy(&out.bytes[i], code.data(), 4);
        return evaluation;
    }

    /// Behind the last slice of the patterns.
    static Result<Evaluation> blank(LinearImage& out) {
        std::fill(out.values.begin(), out.values.end(), 0.0F);
        return Evaluation{.method = "patterns", .work = 1};
    }

    /// Which pattern each cell of a rectangle shows, a row of cells at a time.
    class Patterns {
      public:
        Patterns(const DrawnCells& of, const TexelRegion& at, std::int64_t z, std::int64_t x, std::int64_t y,
                 std::int32_t width, std::int32_t height, ScrollWatch& watch)
            : of_{of}, at_{at}, watch_{watch}, z_{z}, x_{x}, width_{width}, patterns_(std::size_t(width)) {
            if (of.program_->needs_types()) types_ = of.grid_.quadtree->types_of(0, x, y, width, height, z);
        }
        const std::int32_t* row(std::int64_t y) {
            constexpr std::int32_t at_once = 4096;
            for (std::int32_t from = 0; from < width_; from += at_once) {
                CellRow row{.x = x_ + from,
                            .y = y,
                            .count = std::min(at_once, width_ - from),
                            .z = z_,
                            .step = at_.step,
                            .validity = watch_.frames(),
                            .parameter = at_.parameter,
                            .targets = at_.targets};
                if (!types_.types.empty()) row.types = types_.row(y) + (x_ - types_.x) + from;
                of_.program_->patterns(row, patterns_.data() + from);
            }
            watch_.see(x_, y, std::span<const std::int32_t>{patterns_});
            return patterns_.data();
        }

      private:
        const DrawnCells& of_;
        const TexelRegion& at_;
        ScrollWatch& watch_;
        std::int64_t z_, x_;
        std::int32_t width_;
        TypeGrid types_;
        std::vector<std::int32_t> patterns_;
    };

    template <class Image>
    Result<Evaluation> copy(const TexelRegion& region, const CellSlice& at, const Budget& budget,
                            Image& out) const {
        const int side_log2 = grid_.cell_log2 - region.level;
        const std::int64_t x = region.x >> side_log2, y = region.y >> side_log2;
        const auto width = static_cast<std::int32_t>(((region.x + region.width - 1) >> side_log2) - x + 1);
        const auto height = static_cast<std::int32_t>(((region.y + region.height - 1) >> side_log2) - y + 1);
        const auto& all = images_of(region.level, out);
        const std::int32_t first = mips_->first_image(static_cast<std::int32_t>(at.slice));
        ScrollWatch watch{*program_, region, at.z, x, y, width, height};
        Patterns patterns{*this, region, at.z, x, y, width, height, watch};
        CellRowCopy rows{.images = all.row(first << side_log2),
                         .side_log2 = side_log2,
                         .skip = static_cast<std::int32_t>(region.x - (x << side_log2)),
                         .width = region.width,
                         .out_row_texels = std::size_t(region.width)};
        const std::int64_t side = std::int64_t{1} << side_log2;
        for (std::int64_t cell = y; cell < y + height; ++cell) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const std::int64_t top = cell * side;
            rows.index = patterns.row(cell);
            rows.from_row = static_cast<std::int32_t>(std::max<std::int64_t>(region.y - top, 0));
            rows.to_row = static_cast<std::int32_t>(std::min(region.y + region.height - top, side));
            rows.out = out.row(static_cast<std::int32_t>(top + rows.from_row - region.y));
            if constexpr (texel_bytes<Image> == 4) {
                if (side_log2 == 0) {
                    block_kernels().copy_texels(static_cast<const unsigned char*>(rows.images), -1,
                                                mips_->count() + 1, rows.index, region.width,
                                                static_cast<unsigned char*>(rows.out));
                    continue;
                }
            }
            copy_cell_rows<texel_bytes<Image>>(rows);
        }
        return Evaluation{.method = "patterns",
                          .bound_codes = rounding_codes,
                          .work = std::uint64_t(width) * std::uint64_t(height),
                          .validity = watch.interval()};
    }
    const LinearImage& images_of(int level, const LinearImage&) const { return mips_->linear(level); }
    const Rgba8Image& images_of(int level, const Rgba8Image&) const { return mips_->codes(level); }

    /// Texels of n × n cells: sums of the cells' own, in integers.
    Result<Evaluation> sum_cells(const TexelRegion& region, const CellSlice& at, const Budget& budget,
                                 LinearImage& out) const {
        const std::int32_t first = mips_->first_image(static_cast<std::int32_t>(at.slice));
        const int up = region.level - grid_.cell_log2;
        const std::int64_t n = std::int64_t{1} << up;
        const double unit = mips_->sum_unit() * static_cast<double>(n) * static_cast<double>(n);
        // So many texels at a time that a stretch of their cells is decided row after row: what a row reads
        // of the next one is then decided once
        const auto at_once = static_cast<std::int32_t>(std::max<std::int64_t>(summed_cells / n, 1));
        std::vector<std::int64_t> sums;  // Four a texel
        ScrollWatch watch{*program_,        region,           at.z, region.x * n, region.y * n,
                          region.width * n, region.height * n};
        for (std::int32_t row = 0; row < region.height; ++row) {
            const std::int64_t y = (region.y + row) * n;
            float* texel = out.row(row);
            for (std::int32_t from = 0; from < region.width; from += at_once) {
                const std::int32_t count = std::min(at_once, region.width - from);
                Patterns patterns{*this,
                                  region,
                                  at.z,
                                  (region.x + from) * n,
                                  y,
                                  static_cast<std::int32_t>(count * n),
                                  static_cast<std::int32_t>(n),
                                  watch};
                sums.assign(static_cast<std::size_t>(count) * 4, 0);
                for (std::int64_t cell_y = y; cell_y < y + n; ++cell_y) {
                    if (auto spent = check_budget(budget); !spent) return spent.error();
                    const std::int32_t* pattern = patterns.row(cell_y);
                    block_kernels().add_colours(mips_->sum(first).data(), pattern,
                                                static_cast<std::int32_t>(n), count, sums.data());
                }
                block_kernels().divide(sums.data(), unit, 4 * count, texel);
                texel += std::ptrdiff_t{4} * count;
            }
        }
        return Evaluation{
            .method = "cells",
            .bound_codes = rounding_codes,
            .work = std::uint64_t(region.width) * std::uint64_t(region.height) * std::uint64_t(n * n),
            .validity = watch.interval()};
    }

    std::int32_t pattern_at(std::int64_t x, std::int64_t y, std::int64_t z, const TexelRegion& at,
                            Validity& validity) const {
        std::uint16_t type = 0;
        if (program_->needs_types()) type = grid_.quadtree->types_of(0, x, y, 1, 1, z).at(x, y);
        std::int32_t pattern = -1;
        program_->patterns({.x = x,
                            .y = y,
                            .count = 1,
                            .z = z,
                            .step = at.step,
                            .types = &type,
                            .validity = &validity,
                            .parameter = at.parameter,
                            .targets = at.targets},
                           &pattern);
        return pattern;
    }

    /// Larger texels of cells of which nothing is known: one cell of each of many strata, picked by a hash.
    Result<Evaluation> sample_cells(const TexelRegion& region, const CellSlice& at, const Budget& budget,
                                    LinearImage& out) const {
        const std::int32_t first = mips_->first_image(static_cast<std::int32_t>(at.slice));
        const int strata_log2 = sampled_levels(budget.accuracy);
        const int free_log2 = region.level - grid_.cell_log2 - strata_log2;  // bits that are drawn: 1 to 30
        const std::int64_t strata = std::int64_t{1} << strata_log2, mask = (std::int64_t{1} << free_log2) - 1;
        const double unit = mips_->sum_unit() * static_cast<double>(strata * strata);
        const std::uint64_t key = stream("cells of a texel", region.level);
        Validity validity;
        for (std::int32_t y = 0; y < region.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            float* texel = out.row(y);
            for (std::int32_t x = 0; x < region.width; ++x) {
                std::array<std::int64_t, 4> sum{};
                for (std::int64_t i = 0; i < strata * strata; ++i) {
                    const std::int64_t column = (region.x + x) * strata + i % strata;
                    const std::int64_t row = (region.y + y) * strata + i / strata;
                    const std::uint64_t bits = hash(0, key, column, row);
                    const std::int64_t cell_x =
                        column * (mask + 1) + (static_cast<std::int64_t>(bits) & mask);
                    const std::int64_t cell_y =
                        row * (mask + 1) + (static_cast<std::int64_t>(bits >> 32) & mask);
                    const auto& of = mips_->sum(first + pattern_at(cell_x, cell_y, at.z, region, validity));
                    for (std::size_t channel = 0; channel < 4; ++channel) sum[channel] += of[channel];
                }
                for (const std::int64_t channel : sum)
                    *texel++ = static_cast<float>(static_cast<double>(channel) / unit);
            }
        }
        const double codes = chance_codes(width_, static_cast<double>(strata * strata));
        return Evaluation{.method = "sampled",
                          .bound_codes = std::min(codes, 255 * width_) + rounding_codes,
                          .confidence = codes < 255 * width_ ? stated_confidence : 1,
                          .work = std::uint64_t(region.width) * std::uint64_t(region.height) *
                                  std::uint64_t(strata * strata),
                          .validity = in_this_shift(*program_, region.step, validity)};
    }

    struct Periods {
        std::shared_ptr<const PeriodicSums> sums;  ///< Null where too many rows differ.
    };

    Grid grid_;
    std::shared_ptr<const CellProgram> program_;
    std::shared_ptr<const PatternMips> mips_;
    LookMeans means_;
    SliceCache<Periods> periods_;
    double width_ = 0;  ///< That all patterns' means span, of all slices.
    std::optional<EpochExpectation> expectation_;
    int exact_levels_ = enumerated_levels(Accuracy::exact);  ///< Of texels that exact sums cell by cell.
    bool quarters_ = false;  ///< A level more is exact enough where a quarter of its cells are summed.
};

}  // namespace

std::shared_ptr<const PatternTexture> make_cell_texture(const ReferencePlan& plan,
                                                        std::shared_ptr<const PatternMips> mips) {
    if (!mips) mips = std::make_shared<const PatternMips>(*plan.patterns);
    if (plan.program->basis() == CellProgram::Basis::typed) {
        std::vector<std::int32_t> pattern_of_type;
        for (std::uint32_t type = 0; type < plan.grid.quadtree->types(); ++type)
            pattern_of_type.push_back(plan.program->look_of_type(static_cast<std::uint16_t>(type)).pattern);
        return make_typed_texture(plan.grid, std::move(mips), std::move(pattern_of_type));
    }
    return std::make_shared<DrawnCells>(plan, std::move(mips));
}

}  // namespace tessera
