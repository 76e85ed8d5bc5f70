#include "server/pattern/drawn_instances.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "server/pattern/cell_looks.h"
#include "server/pattern/cell_slice.h"
#include "server/pattern/epoch_expectation.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// Rounding to float.
constexpr double rounding_codes = 4e-5;

/// Texels of up to 4^this cells are summed cell by cell: a matter of level and accuracy alone, so that any
/// split of a region gives the same texels.
constexpr int summed_levels(Accuracy accuracy) noexcept {
    return accuracy == Accuracy::exact ? 4 : accuracy == Accuracy::high ? 3 : 0;
}
/// Where nothing is known of larger texels' cells, 4^this of them are looked at.
constexpr int sampled_levels(Accuracy accuracy) noexcept {
    return accuracy == Accuracy::exact ? 4 : accuracy == Accuracy::high ? 3 : 2;
}

class DrawnInstances final : public PatternTexture {
  public:
    DrawnInstances(const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images)
        : plan_{plan}, images_{std::move(images)}, means_{images_->means(plan.grid.cell_log2)} {
        ColourRange range;
        range.add(Colour{});
        for (const auto& mean : means_.means) range.add(mean);
        width_ = range.width();
        expectation_.emplace(plan_.program, means_, width_);
    }

    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        out.width = region.width;
        out.height = region.height;
        out.values.assign(
            static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height) * 4, 0.0F);
        const CellSlice at = cell_slice(plan_.grid, region.slice, plan_.patterns->slices);
        const int up = region.level - plan_.grid.cell_log2;
        if (up <= 0) return draw(region, at, budget, out);
        if (expectation_->certain() || (expectation_->known() && up > summed_levels(budget.accuracy)))
            return expectation_->evaluate(region, at.slice, up, budget, out);
        if (expectation_->known() || up <= sampled_levels(budget.accuracy))
            return sum_cells(region, at, up, budget, out);
        return sample_cells(region, at, up, budget, out);
    }
    std::string_view kind() const noexcept override { return "pattern"; }
    int cell_level() const noexcept override { return expectation_->certain() ? -1 : plan_.grid.cell_log2; }
    std::string description() const override {
        return std::to_string(plan_.patterns->count) + " patterns in " +
               std::to_string(plan_.transform->turns.size()) + " turns and " +
               std::to_string(plan_.transform->scales.size()) + " scales, cells of " +
               std::to_string(std::int64_t{1} << plan_.grid.cell_log2) + " texels, drawn one by one";
    }
    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + images_->memory_bytes() + means_.memory_bytes() +
               plan_.program->memory_bytes() + expectation_->memory_bytes();
    }

  private:
    /// Up to the level of a cell: each texel lies in one cell, which holds all of its instance.
    Result<Evaluation> draw(const TexelRegion& region, const CellSlice& at, const Budget& budget,
                            LinearImage& out) const {
        const int cell_log2 = plan_.grid.cell_log2, side_log2 = cell_log2 - region.level;
        const std::int64_t x = region.x >> side_log2, y = region.y >> side_log2;
        const auto width = static_cast<std::int32_t>(((region.x + region.width - 1) >> side_log2) - x + 1);
        const auto height = static_cast<std::int32_t>(((region.y + region.height - 1) >> side_log2) - y + 1);
        ScrollWatch watch{*plan_.program, region, at.z, x, y, width, height};
        CellLooks looks{plan_, region, at.z, x, y, width, height, &watch};
        for (std::int64_t cell_y = y; cell_y < y + height; ++cell_y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const Look* look = looks.row(cell_y);
            for (std::int64_t cell_x = x; cell_x < x + width; ++cell_x, ++look)
                if (const SummedArea* image = images_->find(*look, static_cast<std::int32_t>(at.slice)))
                    draw_instance(*image, *look, cell_x, cell_y, region, out);
        }
        return Evaluation{.method = "instances",
                          .bound_codes = rounding_codes,
                          .work = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height),
                          .validity = watch.interval()};
    }

    void draw_instance(const SummedArea& image, const Look& look, std::int64_t cell_x, std::int64_t cell_y,
                       const TexelRegion& region, LinearImage& out) const {
        const MetInstance met =
            met_of(region, look, image.width(), cell_x, cell_y, plan_.grid.cell_log2, false);
        const auto [from, to] = met.columns;
        if (from >= to) return;
        for (std::int64_t y = met.rows.from; y < met.rows.to; ++y)
            instance_row(image, met.left, met.top, region.level, y, from, to,
                         out.row(static_cast<std::int32_t>(y - region.y)) + (from - region.x) * 4);
    }

    /// Texels of 2^up × 2^up cells.
    Result<Evaluation> sum_cells(const TexelRegion& region, const CellSlice& at, int up, const Budget& budget,
                                 LinearImage& out) const {
        const std::int64_t n = std::int64_t{1} << up;
        ScrollWatch watch{*plan_.program,   region,           at.z, region.x * n, region.y * n,
                          region.width * n, region.height * n};
        std::vector<Colour> sums(static_cast<std::size_t>(region.width));
        for (std::int32_t row = 0; row < region.height; ++row) {
            std::fill(sums.begin(), sums.end(), Colour{});
            const std::int64_t y = (region.y + row) * n;
            CellLooks looks{plan_,
                            region,
                            at.z,
                            region.x * n,
                            y,
                            static_cast<std::int32_t>(region.width * n),
                            static_cast<std::int32_t>(n),
                            &watch};
            for (std::int64_t cell_y = y; cell_y < y + n; ++cell_y) {
                if (auto spent = check_budget(budget); !spent) return spent.error();
                const Look* look = looks.row(cell_y);
                for (Colour& sum : sums)
                    for (std::int64_t i = 0; i < n; ++i) add(*look++, at.slice, sum);
            }
            write(sums, n * n, out.row(row));
        }
        return Evaluation{.method = "cells",
                          .bound_codes = rounding_codes,
                          .work = cells(region, n),
                          .validity = watch.interval()};
    }

    /// Larger texels of cells of which nothing is known: one cell of each of many parts, picked by a hash.
    Result<Evaluation> sample_cells(const TexelRegion& region, const CellSlice& at, int up,
                                    const Budget& budget, LinearImage& out) const {
        const int parts_log2 = sampled_levels(budget.accuracy);
        const std::int64_t n = std::int64_t{1} << parts_log2, part = std::int64_t{1} << (up - parts_log2);
        const std::uint64_t key = stream("cells of a texel", region.level);
        Validity validity;
        std::vector<Colour> sums(static_cast<std::size_t>(region.width));
        for (std::int32_t row = 0; row < region.height; ++row) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            std::fill(sums.begin(), sums.end(), Colour{});
            for (std::size_t x = 0; x < sums.size(); ++x)
                for (std::int64_t i = 0; i < n * n; ++i) {
                    const std::int64_t part_x = (region.x + static_cast<std::int64_t>(x)) * n + i % n;
                    const std::int64_t part_y = (region.y + row) * n + i / n;
                    const std::uint64_t bits = hash(0, key, part_x, part_y);
                    const std::int64_t cell_x =
                        part_x * part + (static_cast<std::int64_t>(bits) & (part - 1));
                    const std::int64_t cell_y =
                        part_y * part + (static_cast<std::int64_t>(bits >> 32) & (part - 1));
                    CellLooks looks{plan_, region, at.z, cell_x, cell_y, 1, 1};
                    add(*looks.row(cell_y), at.slice, sums[x]);
                    validity.meet(looks.validity());
                }
            write(sums, n * n, out.row(row));
        }
        const double codes = chance_codes(width_, static_cast<double>(n * n));
        return Evaluation{.method = "sampled",
                          .bound_codes = std::min(codes, 255 * width_) + rounding_codes,
                          .confidence = codes < 255 * width_ ? stated_confidence : 1,
                          .work = cells(region, n),
                          .validity = in_this_shift(*plan_.program, region.step, validity)};
    }

    static std::uint64_t cells(const TexelRegion& region, std::int64_t n) noexcept {
        return static_cast<std::uint64_t>(region.width) * static_cast<std::uint64_t>(region.height) *
               static_cast<std::uint64_t>(n * n);
    }
    static void write(const std::vector<Colour>& sums, std::int64_t count, float* texel) noexcept {
        const double share = 1.0 / static_cast<double>(count);
        for (const Colour& sum : sums)
            for (const double channel : sum) *texel++ = static_cast<float>(channel * share);
    }
    void add(const Look& look, std::int64_t slice, Colour& sum) const noexcept {
        const Colour mean = means_.of(look, static_cast<std::int32_t>(slice));
        for (std::size_t c = 0; c < 4; ++c) sum[c] += mean[c];
    }

    ReferencePlan plan_;
    std::shared_ptr<const InstanceImages> images_;
    LookMeans means_;
    double width_ = 0;  ///< That the means of all looks span.
    std::optional<EpochExpectation> expectation_;
};

}  // namespace

std::shared_ptr<const PatternTexture> make_drawn_instances(const ReferencePlan& plan,
                                                           std::shared_ptr<const InstanceImages> images) {
    return std::make_shared<DrawnInstances>(plan, std::move(images));
}

}  // namespace tessera
