#include "server/pattern/drawn_instances.h"

#include <algorithm>
#include <list>
#include <mutex>
#include <utility>
#include <vector>

#include "server/pattern/area_expectation.h"
#include "server/pattern/cell_looks.h"
#include "server/pattern/cell_slice.h"

namespace tessera {
namespace {

/// Rounding to float.
constexpr double rounding_codes = 4e-5;
/// Expectations of so many slices are kept at a time.
constexpr std::size_t kept_slices = 8;

/// A texel of more than 4^m cells is expected, not summed: a matter of level and accuracy alone, so that any
/// split of a region gives the same texels.
int most_summed(Accuracy accuracy) noexcept {
    return accuracy == Accuracy::exact ? 4 : accuracy == Accuracy::high ? 3 : 0;
}

class DrawnInstances final : public PatternTexture {
  public:
    DrawnInstances(const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images)
        : plan_{plan}, images_{std::move(images)}, means_{images_->means(plan.grid.cell_log2)} {
        ColourRange range;
        range.add(Colour{});
        for (const auto& mean : means_.means) range.add(mean);
        width_codes_ = 255 * range.width();
        expectation(0);
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
        if (up > most_summed(budget.accuracy))
            if (const auto expected = expectation(at.slice))
                return expected->evaluate(region, up, budget, out);
        return sum_cells(region, at, up, budget, out);
    }
    std::string_view kind() const noexcept override { return "pattern"; }
    int cell_level() const noexcept override { return plan_.grid.cell_log2; }
    std::string description() const override {
        return std::to_string(plan_.patterns->count) + " patterns in " +
               std::to_string(plan_.transform->turns.size()) + " turns and " +
               std::to_string(plan_.transform->scales.size()) + " scales, cells of " +
               std::to_string(std::int64_t{1} << plan_.grid.cell_log2) + " texels, drawn one by one";
    }
    std::size_t memory_bytes() const noexcept override {
        const auto expected = expectation(0);
        return sizeof *this + images_->memory_bytes() + means_.memory_bytes() +
               plan_.program->memory_bytes() +
               (expected ? expected->memory_bytes() *
                               std::min<std::size_t>(kept_slices, static_cast<std::size_t>(means_.slices))
                         : 0);
    }

  private:
    /// Made when a slice is first asked for; those used last are kept.
    std::shared_ptr<const AreaExpectation> expectation(std::int64_t slice) const {
        const std::lock_guard lock{mutex_};
        const auto found =
            std::find_if(kept_.begin(), kept_.end(), [&](const auto& kept) { return kept.first == slice; });
        if (found != kept_.end()) {
            kept_.splice(kept_.begin(), kept_, found);
        } else {
            kept_.emplace_front(
                slice, make_area_expectation(*plan_.program, means_, static_cast<std::int32_t>(slice)));
            if (kept_.size() > kept_slices) kept_.pop_back();
        }
        return kept_.front().second;
    }

    /// Up to the level of a cell: each texel lies in one cell, which holds all of its instance.
    Result<Evaluation> draw(const TexelRegion& region, const CellSlice& at, const Budget& budget,
                            LinearImage& out) const {
        const int cell_log2 = plan_.grid.cell_log2, side_log2 = cell_log2 - region.level;
        const std::int64_t x = region.x >> side_log2, y = region.y >> side_log2;
        const auto width = static_cast<std::int32_t>(((region.x + region.width - 1) >> side_log2) - x + 1);
        const auto height = static_cast<std::int32_t>(((region.y + region.height - 1) >> side_log2) - y + 1);
        CellLooks looks{plan_, at.z, x, y, width, height};
        for (std::int64_t cell_y = y; cell_y < y + height; ++cell_y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const Look* look = looks.row(cell_y);
            for (std::int64_t cell_x = x; cell_x < x + width; ++cell_x, ++look)
                if (const SummedArea* image = images_->find(*look, static_cast<std::int32_t>(at.slice)))
                    draw_instance(*image, *look, cell_x, cell_y, region, out);
        }
        return Evaluation{.method = "instances",
                          .bound_codes = rounding_codes,
                          .work = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height)};
    }

    void draw_instance(const SummedArea& image, const Look& look, std::int64_t cell_x, std::int64_t cell_y,
                       const TexelRegion& region, LinearImage& out) const {
        const int cell_log2 = plan_.grid.cell_log2;
        const CellPlace place = place_in_cell(look, image.width(), cell_log2, false);
        const std::int64_t side = std::int64_t{1} << cell_log2;
        const std::int64_t left = cell_x * side + place.left, top = cell_y * side + place.top;
        const TexelSpan columns = texels_met(left, image.width(), region.level);
        const TexelSpan rows = texels_met(top, image.height(), region.level);
        const std::int64_t from = std::max(columns.from, region.x);
        const std::int64_t to = std::min(columns.to, region.x + region.width);
        if (from >= to) return;
        const std::int64_t bottom = std::min(rows.to, region.y + region.height);
        for (std::int64_t y = std::max(rows.from, region.y); y < bottom; ++y)
            instance_row(image, left, top, region.level, y, from, to,
                         out.row(static_cast<std::int32_t>(y - region.y)) + (from - region.x) * 4);
    }

    /// Texels of 2^up × 2^up cells. All of them, or, where that is never affordable and nothing is known of
    /// the cells' looks, one from the middle of each of 64 parts of the texel.
    Result<Evaluation> sum_cells(const TexelRegion& region, const CellSlice& at, int up, const Budget& budget,
                                 LinearImage& out) const {
        const int looked_at = std::min(up, std::max(most_summed(budget.accuracy), 3));
        const std::int64_t n = std::int64_t{1} << looked_at, apart = std::int64_t{1} << (up - looked_at);
        const double share = 1.0 / static_cast<double>(n * n);
        std::vector<Colour> sums(static_cast<std::size_t>(region.width));
        for (std::int32_t row = 0; row < region.height; ++row) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            std::fill(sums.begin(), sums.end(), Colour{});
            for (std::int64_t j = 0; j < n; ++j) {
                const std::int64_t cell_y = ((region.y + row) * n + j) * apart + apart / 2;
                if (apart == 1) {
                    CellLooks looks{
                        plan_, at.z, region.x * n, cell_y, static_cast<std::int32_t>(region.width * n), 1};
                    const Look* look = looks.row(cell_y);
                    for (Colour& sum : sums)
                        for (std::int64_t i = 0; i < n; ++i) add(*look++, at.slice, sum);
                    continue;
                }
                for (std::size_t x = 0; x < sums.size(); ++x)
                    for (std::int64_t i = 0; i < n; ++i) {
                        const std::int64_t cell_x =
                            ((region.x + static_cast<std::int64_t>(x)) * n + i) * apart + apart / 2;
                        CellLooks looks{plan_, at.z, cell_x, cell_y, 1, 1};
                        add(*looks.row(cell_y), at.slice, sums[x]);
                    }
            }
            float* texel = out.row(row);
            for (const Colour& sum : sums)
                for (const double channel : sum) *texel++ = static_cast<float>(channel * share);
        }
        const double missing = 1 - 1 / static_cast<double>(apart) / static_cast<double>(apart);
        return Evaluation{.method = apart == 1 ? "cells" : "sampled cells",
                          .bound_codes = rounding_codes + missing * width_codes_,
                          .work = static_cast<std::uint64_t>(region.width) *
                                  static_cast<std::uint64_t>(region.height) *
                                  static_cast<std::uint64_t>(n * n)};
    }
    void add(const Look& look, std::int64_t slice, Colour& sum) const noexcept {
        const Colour mean = means_.of(look, static_cast<std::int32_t>(slice));
        for (std::size_t c = 0; c < 4; ++c) sum[c] += mean[c];
    }

    ReferencePlan plan_;
    std::shared_ptr<const InstanceImages> images_;
    LookMeans means_;
    double width_codes_ = 0;  ///< Between the means of any two looks, at most.
    mutable std::mutex mutex_;
    mutable std::list<std::pair<std::int64_t, std::shared_ptr<const AreaExpectation>>> kept_;
};

}  // namespace

std::shared_ptr<const PatternTexture> make_drawn_instances(const ReferencePlan& plan,
                                                           std::shared_ptr<const InstanceImages> images) {
    return std::make_shared<DrawnInstances>(plan, std::move(images));
}

}  // namespace tessera
