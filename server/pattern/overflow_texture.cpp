#include "server/pattern/overflow_texture.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
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
#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr double rounding_codes = 4e-5;
/// The sample that tells how much instances hide of each other: squares of 2 × 2 cells, so many of them, or
/// texels, and out of how many along each axis they are drawn.
constexpr int sampled_cells_log2 = 1;
constexpr std::int64_t most_squares = 1024, most_sampled_texels = std::int64_t{1} << 24;
constexpr std::uint32_t places = 1 << 20;

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
        if (const auto law = draw_law(plan)) measured_.emplace(*this, *law);
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

    const MeasuredError* measured() const noexcept override { return measured_ ? &*measured_ : nullptr; }

    Result<Evaluation> compose(const TexelRegion& region, const Budget& budget, LinearImage& out,
                               std::vector<float>& bounds) const override {
        if (region.level == 0) return compose_texels(region, budget, out, bounds);
        return region.level <= plan_.grid.cell_log2 ? compose_means(region, budget, out, bounds)
                                                    : compose_sums(region, budget, out, bounds);
    }

  private:
    /// Up to the level of a cell: the instances of each texel's cell, and of those left of it and above.
    /// `add(texels, y, from)`: a row of an instance's texels, from a column of the region on.
    template <class Add>
    Result<Evaluation> for_instances(const TexelRegion& region, const Budget& budget, const Add& add) const {
        const int side_log2 = plan_.grid.cell_log2 - region.level;
        const std::int64_t x = (region.x >> side_log2) - 1, y = (region.y >> side_log2) - 1;
        const auto width = static_cast<std::int32_t>(((region.x + region.width - 1) >> side_log2) - x + 1);
        const auto height = static_cast<std::int32_t>(((region.y + region.height - 1) >> side_log2) - y + 1);
        const CellSlice at = cell_slice(plan_.grid, region.slice, plan_.patterns->slices);
        ScrollWatch watch{*plan_.program, region, at.z, x, y, width, height};
        CellLooks looks{plan_, region, at.z, x, y, width, height, &watch};
        std::vector<float> texels;
        for (std::int64_t cell_y = y; cell_y < y + height; ++cell_y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const Look* look = looks.row(cell_y);
            for (std::int64_t cell_x = x; cell_x < x + width; ++cell_x, ++look) {
                const SummedArea* image = images_->find(*look, static_cast<std::int32_t>(at.slice));
                if (image == nullptr) continue;
                const MetInstance met =
                    met_of(region, *look, image->width(), cell_x, cell_y, plan_.grid.cell_log2, true);
                const auto [from, to] = met.columns;
                if (from >= to) continue;
                texels.resize(static_cast<std::size_t>(to - from) * 4);
                for (std::int64_t row = met.rows.from; row < met.rows.to; ++row) {
                    instance_row(*image, met.left, met.top, region.level, row, from, to, texels.data());
                    add(texels, static_cast<std::int32_t>(row - region.y),
                        static_cast<std::int32_t>(from - region.x));
                }
            }
        }
        return Evaluation{.method = "instances",
                          .bound_codes = rounding_codes,
                          .work = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height),
                          .validity = watch.interval()};
    }

    /// Level 0, where a texel is one value.
    Result<Evaluation> compose_texels(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                      std::vector<float>& bounds) const {
        out = LinearImage{region.width, region.height};
        bounds.assign(out.values.size() / 4, 0.0F);
        return for_instances(region, budget,
                             [&](const std::vector<float>& texels, std::int32_t y, std::int32_t from) {
                                 put_over(texels, out.row(y) + std::ptrdiff_t{from} * 4);
                             });
    }

    Result<Evaluation> compose_means(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                     std::vector<float>& bounds) const {
        out = LinearImage{region.width, region.height};
        std::vector<KnownMeans> means(out.values.size() / 4);
        const MeansOver over{range_, range_, false};
        auto evaluation = for_instances(
            region, budget, [&](const std::vector<float>& texels, std::int32_t y, std::int32_t from) {
                KnownMeans* mean = means.data() + std::ptrdiff_t{y} * region.width + from;
                for (std::size_t i = 0; i < texels.size(); i += 4, ++mean)
                    if (texels[i + 3] > 0) over(&texels[i], 0, *mean);
            });
        if (!evaluation) return evaluation;
        bounds.resize(means.size());
        for (std::size_t i = 0; i < means.size(); ++i) {
            std::copy_n(means[i].estimate.begin(), 4, &out.values[i * 4]);
            bounds[i] = means[i].bound();
        }
        return evaluation;
    }

    /// Above the cell. With S the sum of all instances and R the texture, R's alpha lies between S/4 (at most
    /// four meet, and R is at least as opaque as any of them) and S; its colours are at most S, and between
    /// the least and the most straight colour times its alpha. Instances are counted in their own cells:
    /// those that hang over the texel's border make a difference of at most so many cells as there are along
    /// two of its sides.
    Result<Evaluation> compose_sums(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                    std::vector<float>& bounds) const {
        Result<Evaluation> sums = sums_->evaluate(region, budget, out);
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

    /// Which share of the instances' sum the texture shows, where it was looked at: in squares of cells all
    /// over the plane.
    void sample() const {
        const int square_log2 = plan_.grid.cell_log2 + sampled_cells_log2;
        const std::int64_t squares =
            std::clamp<std::int64_t>(most_sampled_texels >> 2 * square_log2, 1, most_squares);
        const std::int32_t side = std::int32_t{1} << square_log2;
        const std::uint64_t key = stream("sampled squares");
        Colour shown{}, all{};
        for (std::int64_t i = 0; i < squares; ++i) {
            const std::int64_t x = uniform_below(hash(0, key, i, 0), places),
                               y = uniform_below(hash(0, key, i, 1), places);
            LinearImage image{side, side};
            std::fill(image.values.begin(), image.values.end(), 0.0F);
            const auto put = [&](const std::vector<float>& texels, std::int32_t row, std::int32_t from) {
                put_over(texels, image.row(row) + std::ptrdiff_t{from} * 4);
                Colour sum{};
                for (std::size_t k = 0; k < texels.size(); ++k) sum[k % 4] += double{texels[k]};
                for (std::size_t c = 0; c < 4; ++c) all[c] += sum[c];
            };
            if (!for_instances({0, x << square_log2, y << square_log2, side, side, 0}, Budget{}, put)) return;
            Colour sum{};
            for (std::size_t k = 0; k < image.values.size(); ++k) sum[k % 4] += double{image.values[k]};
            for (std::size_t c = 0; c < 4; ++c) shown[c] += sum[c];
        }
        for (std::size_t c = 0; c < 4; ++c)
            shown_[c] = all[c] > 0 ? static_cast<float>(std::min(shown[c] / all[c], 1.0)) : 1.0F;
    }
    static void put_over(const std::vector<float>& texels, float* below) noexcept {
        for (std::size_t i = 0; i < texels.size(); i += 4) {
            const float rest = 1 - texels[i + 3];
            for (std::size_t c = 0; c < 4; ++c) below[i + c] = texels[i + c] + rest * below[i + c];
        }
    }

    ReferencePlan plan_;
    std::shared_ptr<const InstanceImages> images_;
    TexelRange range_;
    std::shared_ptr<const Texture> sums_;
    std::optional<MeasuredError> measured_;
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
