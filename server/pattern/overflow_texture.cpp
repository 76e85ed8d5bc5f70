#include "server/pattern/overflow_texture.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>
#include <vector>

#include "server/pattern/area_sums.h"
#include "server/pattern/cell_looks.h"
#include "server/pattern/cell_slice.h"
#include "server/pattern/descent.h"
#include "server/pattern/drawn_instances.h"
#include "server/pattern/instance_images.h"
#include "server/pattern/mean_products.h"
#include "server/pattern/typed_texture.h"

namespace tessera {
namespace {

constexpr double rounding_codes = 4e-5;
/// Cells along a side of the sample that tells how much instances hide of each other, and texels.
constexpr std::int32_t most_sampled_cells = 64;
constexpr std::int64_t most_sampled_texels = 1024;

/// All of an instance counted in its own cell, evenly: only levels from the cell's on mean anything.
class InstanceSums final : public TypeImages {
  public:
    InstanceSums(const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images)
        : plan_{plan}, images_{std::move(images)}, means_{images_->means(plan.grid.cell_log2)} {}
    void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const override {
        const std::int32_t side = std::int32_t{1} << (plan_.grid.cell_log2 - level);
        const auto mean = means_.of(plan_.program->look_of_type(type), slice);
        out = LinearImage{side, side};
        for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = static_cast<float>(mean[i % 4]);
    }
    std::int32_t slices() const noexcept override { return plan_.patterns->slices; }
    std::size_t memory_bytes() const noexcept override {
        return images_->memory_bytes() + means_.memory_bytes();
    }
    std::string description() const override { return "sums of instances"; }

  private:
    ReferencePlan plan_;
    std::shared_ptr<const InstanceImages> images_;
    LookMeans means_;
};

std::shared_ptr<const Texture> make_sums(const ReferencePlan& plan,
                                         const std::shared_ptr<const InstanceImages>& images) {
    Grid grid = plan.grid;
    switch (plan.program->basis()) {
        case CellProgram::Basis::constant:
            grid.quadtree = std::make_shared<TypedQuadtree>(0, 64);
            [[fallthrough]];
        case CellProgram::Basis::typed:
            return make_typed_texture(grid, std::make_shared<InstanceSums>(plan, images));
        default:
            return make_drawn_instances(plan, images);
    }
}

class OverflowTexture final : public PatternTexture, public Composite {
  public:
    OverflowTexture(const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images)
        : plan_{plan},
          images_{std::move(images)},
          range_{texel_range(plan)},
          sums_{make_sums(plan, images_)} {
        for (const auto& mean : images_->means(plan.grid.cell_log2).means)
            for (const double channel : mean)
                largest_mean_ = std::max(largest_mean_, static_cast<float>(channel));
    }

    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        return evaluate_descending(*this, region, budget, out);
    }
    std::string_view kind() const noexcept override { return "pattern"; }
    int cell_level() const noexcept override { return plan_.grid.cell_log2; }
    std::string description() const override {
        return std::to_string(plan_.patterns->count) + " patterns in " +
               std::to_string(plan_.transform->turns.size()) + " turns and " +
               std::to_string(plan_.transform->scales.size()) + " scales, hanging over cells of " +
               std::to_string(std::int64_t{1} << plan_.grid.cell_log2) + " texels";
    }
    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + sums_->memory_bytes();  // Which hold the images, too
    }

    /// Up to four meet; on average fewer than two.
    int parts() const noexcept override { return 2; }
    int mended_from() const noexcept override { return plan_.grid.cell_log2; }

    Result<Evaluation> compose(const TexelRegion& region, const Budget& budget, LinearImage& out,
                               std::vector<float>& bounds) const override {
        return region.level <= plan_.grid.cell_log2 ? compose_instances(region, budget, out, bounds)
                                                    : compose_sums(region, budget, out, bounds);
    }

  private:
    /// Up to the level of a cell: the instances of each texel's cell, and of those left of it and above.
    Result<Evaluation> compose_instances(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                         std::vector<float>& bounds) const {
        out = LinearImage{region.width, region.height};
        std::vector<KnownMeans> means(out.values.size() / 4);
        const int side_log2 = plan_.grid.cell_log2 - region.level;
        const std::int64_t x = (region.x >> side_log2) - 1, y = (region.y >> side_log2) - 1;
        const auto width = static_cast<std::int32_t>(((region.x + region.width - 1) >> side_log2) - x + 1);
        const auto height = static_cast<std::int32_t>(((region.y + region.height - 1) >> side_log2) - y + 1);
        const CellSlice at = cell_slice(plan_.grid, region.slice, plan_.patterns->slices);
        CellLooks looks{plan_, region, at.z, x, y, width, height};
        const MeansOver over{range_, range_, region.level == 0};
        std::vector<float> texels;
        for (std::int64_t cell_y = y; cell_y < y + height; ++cell_y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const Look* look = looks.row(cell_y);
            for (std::int64_t cell_x = x; cell_x < x + width; ++cell_x, ++look)
                if (const SummedArea* image = images_->find(*look, static_cast<std::int32_t>(at.slice)))
                    add_instance(*image, *look, cell_x, cell_y, region, over, texels, means);
        }
        bounds.resize(means.size());
        for (std::size_t i = 0; i < means.size(); ++i) {
            std::copy_n(means[i].estimate.begin(), 4, &out.values[i * 4]);
            bounds[i] = means[i].bound();
        }
        return Evaluation{.method = "instances",
                          .bound_codes = rounding_codes,
                          .work = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height),
                          .validity = looks.validity()};
    }

    void add_instance(const SummedArea& image, const Look& look, std::int64_t cell_x, std::int64_t cell_y,
                      const TexelRegion& region, const MeansOver& over, std::vector<float>& texels,
                      std::vector<KnownMeans>& means) const {
        const MetInstance met =
            met_of(region, look, image.width(), cell_x, cell_y, plan_.grid.cell_log2, true);
        const auto [from, to] = met.columns;
        if (from >= to) return;
        texels.resize(static_cast<std::size_t>(to - from) * 4);
        for (std::int64_t y = met.rows.from; y < met.rows.to; ++y) {
            instance_row(image, met.left, met.top, region.level, y, from, to, texels.data());
            KnownMeans* mean = means.data() + (y - region.y) * region.width + (from - region.x);
            for (const float* texel = texels.data(); texel != texels.data() + texels.size();
                 texel += 4, ++mean)
                if (texel[3] > 0) over(texel, 0, *mean);
        }
    }

    /// Above the cell. With S the sum of all instances and R the texture, R's alpha lies between S/4 (at most
    /// four meet, and R is at least as opaque as any of them) and S; its colours are at most S, and between
    /// the least and the most straight colour times its alpha. Instances are counted in their own cells:
    /// those that hang over the texel's border make a difference of at most so many cells as there are along
    /// two of its sides.
    Result<Evaluation> compose_sums(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                    std::vector<float>& bounds) const {
        // More than the sum's error is in what instances hide of each other: no need to look at more cells
        Budget enough = budget;
        if (enough.accuracy == Accuracy::exact) enough.accuracy = Accuracy::high;
        Result<Evaluation> sums = sums_->evaluate(region, enough, out);
        if (!sums) return sums;
        const double cells = static_cast<double>(std::int64_t{1} << (region.level - plan_.grid.cell_log2));
        const auto error = static_cast<float>(sums->bound_codes * code_in_linear +
                                              (2 * cells + 1) / cells / cells * double{largest_mean_});
        bounds.resize(out.values.size() / 4);
        std::call_once(sampled_, [this] { sample(); });
        for (std::size_t i = 0; i < bounds.size(); ++i) {
            float* texel = &out.values[i * 4];
            KnownMeans mean;
            const float alpha_least = std::max((texel[3] - error) / 4, 0.0F);
            const float alpha_most = std::min(texel[3] + error, 1.0F);
            for (std::size_t c = 0; c < 4; ++c) {
                mean.least[c] = range_.straight_least[c] * alpha_least;
                mean.most[c] =
                    std::max(std::min(texel[c] + error, range_.straight_most[c] * alpha_most), mean.least[c]);
                mean.estimate[c] = std::clamp(texel[c] * shown_[c], mean.least[c], mean.most[c]);
                texel[c] = mean.estimate[c];
            }
            bounds[i] = mean.bound();
        }
        sums->method = "expectation";
        return sums;
    }

    /// Which share of the instances' sum the texture shows, where it was looked at.
    void sample() const {
        const std::int64_t side = std::int64_t{1} << plan_.grid.cell_log2;
        const std::int64_t texels =
            std::clamp<std::int64_t>(most_sampled_texels, side, side * most_sampled_cells);
        const auto strip = static_cast<std::int32_t>(std::min<std::int64_t>(side, 256));
        Colour shown{}, all{};
        LinearImage image;
        std::vector<float> bounds;
        TexelRegion region{.width = static_cast<std::int32_t>(texels), .height = strip};
        for (; region.y < texels; region.y += strip) {
            if (!compose_instances(region, Budget{}, image, bounds)) return;
            for (std::size_t i = 0; i < image.values.size(); ++i) shown[i % 4] += double{image.values[i]};
        }
        const auto cells = static_cast<std::int32_t>(texels / side);
        const LookMeans means = images_->means(plan_.grid.cell_log2);
        CellLooks looks{plan_, TexelRegion{}, 0, 0, 0, cells, cells};
        for (std::int32_t y = 0; y < cells; ++y) {
            const Look* look = looks.row(y);
            for (std::int32_t x = 0; x < cells; ++x, ++look) {
                const Colour mean = means.of(*look, 0);
                for (std::size_t c = 0; c < 4; ++c) all[c] += mean[c] * static_cast<double>(side * side);
            }
        }
        for (std::size_t c = 0; c < 4; ++c)
            shown_[c] = all[c] > 0 ? static_cast<float>(std::min(shown[c] / all[c], 1.0)) : 1.0F;
    }

    ReferencePlan plan_;
    std::shared_ptr<const InstanceImages> images_;
    TexelRange range_;
    std::shared_ptr<const Texture> sums_;
    float largest_mean_ = 0;
    mutable std::once_flag sampled_;  ///< When a level above the cell is asked for first.
    mutable std::array<float, 4> shown_{1, 1, 1, 1};
};

}  // namespace

std::shared_ptr<const PatternTexture> make_overflow_texture(const ReferencePlan& plan,
                                                            std::shared_ptr<const InstanceImages> images) {
    if (!images) images = std::make_shared<const InstanceImages>(plan);
    return std::make_shared<OverflowTexture>(plan, std::move(images));
}

}  // namespace tessera
