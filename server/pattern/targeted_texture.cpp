#include "server/pattern/targeted_texture.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "server/blocks/animation_op.h"
#include "server/pattern/descent.h"

namespace tessera {
namespace {

/// Changes are summed in these parts of linear light, as sprites' are.
constexpr double sum_unit = 0x1p32;
constexpr double rounding_codes = 1e-4;
/// Cells near targets are looked at in blocks of so many.
constexpr int block_log2 = 5;

constexpr std::size_t most_blocks(Accuracy accuracy) noexcept {
    return std::size_t{1} << ((accuracy == Accuracy::exact  ? 24
                               : accuracy == Accuracy::high ? 22
                                                            : 20) -
                              2 * block_log2);
}

/// How a pattern looks at targets; shared by all that differ in targets only.
struct Looking {
    std::vector<TargetLaw> laws;
    int cell_log2 = max_level;  ///< Of the finest cells that look at targets.
    bool one_grid = true;       ///< All of them are of that size, stand still, and keep to their own cells.
    bool in_blocks = false;     ///< A composite, which looks at blocks of texels.
    std::int64_t margin = 0;    ///< Texels that what a cell shows may hang over its middle, along an axis.
    std::int64_t reach = 0;     ///< Of the law that reaches furthest.
};

Looking looking_of(const Texture& pattern, const Plan& plan) {
    Looking looking{.laws = plan.target_laws,
                    .in_blocks = dynamic_cast<const Composite*>(&pattern) != nullptr};
    for (const PlannedTexture& texture : plan.textures) {
        const auto* cells = std::get_if<ReferencePlan>(&texture.what);
        if (cells == nullptr || !cells->program->looks_at_targets()) continue;
        const std::int64_t side = std::int64_t{1} << cells->grid.cell_log2;
        looking.one_grid &= looking.cell_log2 == max_level || looking.cell_log2 == cells->grid.cell_log2;
        looking.one_grid &= !cells->transform || !cells->transform->overflow;
        looking.one_grid &= cells->program->scroll().cells == 0;
        looking.cell_log2 = std::min(looking.cell_log2, cells->grid.cell_log2);
        // Half a cell to its border, and a cell more that an instance may hang over
        const bool overflows = cells->transform && cells->transform->overflow;
        looking.margin = std::max(looking.margin, overflows ? 2 * side : side);
    }
    for (const TargetLaw& law : looking.laws) looking.reach = std::max(looking.reach, law.far);
    if (looking.cell_log2 == max_level) looking.laws.clear();  // They reach no texture
    return looking;
}

TexelBox texels_of(const TexelRegion& region) noexcept {
    const std::int64_t side = std::int64_t{1} << region.level;
    return {region.x * side, region.y * side, (region.x + region.width) * side,
            (region.y + region.height) * side};
}

TexelBox common(const TexelBox& a, const TexelBox& b) noexcept {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

class TargetedTexture final : public PatternTexture {
  public:
    TargetedTexture(std::shared_ptr<const Texture> pattern, std::shared_ptr<const Looking> looking,
                    std::span<const MovingTarget> targets)
        : pattern_{std::move(pattern)}, looking_{std::move(looking)} {
        const auto shared = std::make_shared<const std::vector<MovingTarget>>(targets.begin(), targets.end());
        for (const TargetLaw& law : looking_->laws)
            distances_.laws.emplace_back(law.frames->line, law.near, law.far, shared);
        distances_.tell_validity = !looking_->one_grid;
        for (const MovingTarget& target : targets)
            if (target.moves()) round_ = target.round_steps();
    }

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        if (!reached(region)) return pattern_->evaluate(region, budget, out);
        if (region.level <= looking_->cell_log2) return evaluate_cells(region, budget, out);
        auto done = pattern_->evaluate(region, budget, out);
        if (!done) return done;
        return add_changes(region, budget, *done, out);
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (!reached(region)) return pattern_->evaluate(region, budget, out);
        if (region.level <= looking_->cell_log2) return evaluate_cells(region, budget, out);
        return Texture::evaluate(region, budget, out);
    }
    TexelKind texel_kind() const noexcept override { return pattern_->texel_kind(); }
    std::string_view kind() const noexcept override { return pattern_->kind(); }
    int cell_level() const noexcept override {
        const auto* cells = dynamic_cast<const PatternTexture*>(pattern_.get());
        return cells != nullptr ? cells->cell_level() : -1;
    }
    std::string description() const override {
        return pattern_->description() + "; looks at " +
               std::to_string(distances_.laws.front().targets().size()) + " targets";
    }
    std::size_t memory_bytes() const noexcept override {
        std::size_t legs = 0;
        for (const MovingTarget& target : distances_.laws.front().targets()) legs += target.legs().size();
        return sizeof *this + pattern_->memory_bytes() + legs * 32;
    }

    const std::shared_ptr<const Texture>& pattern() const noexcept { return pattern_; }
    const std::shared_ptr<const Looking>& looking() const noexcept { return looking_; }
    bool moves() const noexcept { return round_ > 0; }

  private:
    TexelRegion seeing(TexelRegion region) const noexcept {
        region.targets = &distances_;
        return region;
    }
    bool reached(const TexelRegion& region) const noexcept {
        const TexelBox box = texels_of(region);
        const std::int64_t margin = looking_->margin;
        return std::any_of(distances_.laws.begin(), distances_.laws.end(), [&](const TargetDistance& law) {
            return law.ever_near({box.x0 - margin, box.y0 - margin}, {box.x1 + margin, box.y1 + margin});
        });
    }

    /// Up to the level of the cells: where all of them show their first frame, as if there were no targets,
    /// but for a while only.
    template <class Image>
    Result<Evaluation> evaluate_cells(const TexelRegion& region, const Budget& budget, Image& out) const {
        if (!looking_->one_grid) return pattern_->evaluate(seeing(region), budget, out);
        const MotionLattice middles = middles_of(region);
        if (const auto rest = rest_of(middles, region.step)) {
            auto done = pattern_->evaluate(region, budget, out);
            if (done) done->validity.meet(*rest);
            return done;
        }
        auto done = pattern_->evaluate(seeing(region), budget, out);
        if (done) narrow(middles, region.step, done->validity);
        return done;
    }
    /// Of all cells that decide what the region shows.
    MotionLattice middles_of(const TexelRegion& region) const noexcept {
        const int log2 = looking_->cell_log2;
        TexelBox box = texels_of(region);
        if (looking_->in_blocks) {
            const std::int64_t side = std::int64_t{1} << (block_log2 + std::min<int>(region.level, log2));
            box = {box.x0 & -side, box.y0 & -side, (box.x1 + side - 1) & -side, (box.y1 + side - 1) & -side};
        }
        const std::int64_t side = std::int64_t{1} << log2, left = box.x0 >> log2, top = box.y0 >> log2;
        return {{left * side + side / 2, top * side + side / 2},
                side,
                ((box.x1 - 1) >> log2) - left + 1,
                ((box.y1 - 1) >> log2) - top + 1};
    }
    std::optional<Validity> rest_of(const MotionLattice& middles, Step step) const noexcept {
        Validity all;
        for (const TargetDistance& law : distances_.laws) {
            const auto rest = law.rest_of(middles, step);
            if (!rest) return std::nullopt;
            all.meet(*rest);
        }
        return all;
    }
    void narrow(const MotionLattice& middles, Step step, Validity& validity) const {
        for (const TargetDistance& law : distances_.laws) law.narrow(middles, step, validity);
    }

    /// Row and column of blocks of cells.
    using Blocks = std::set<std::pair<std::int64_t, std::int64_t>>;

    /// Adds the blocks whose cells show another than their first frame at any of the steps from `ahead` steps
    /// before `step` to as many after it, and that meet the region. False if they are more than `most`.
    bool add_blocks(const TexelRegion& region, Step ahead, std::size_t most, Blocks& blocks) const {
        const std::int64_t grow = looking_->reach + looking_->margin;
        const int side_log2 = looking_->cell_log2 + block_log2;
        for (const MovingTarget& target : distances_.laws.front().targets()) {
            const MovingTarget::Box path =
                target.box(add_steps(region.step, -ahead), add_steps(region.step, ahead + 1));
            const TexelBox box = common(
                {path.least.x - grow, path.least.y - grow, path.most.x + grow + 1, path.most.y + grow + 1},
                texels_of(region));
            if (box.empty()) continue;
            const std::int64_t left = box.x0 >> side_log2, right = (box.x1 - 1) >> side_log2,
                               top = box.y0 >> side_log2, bottom = (box.y1 - 1) >> side_log2;
            const auto wide = static_cast<std::uint64_t>(right - left + 1),
                       high = static_cast<std::uint64_t>(bottom - top + 1);
            if (wide > most || high > most || wide * high > most) return false;
            for (std::int64_t row = top; row <= bottom; ++row)
                for (std::int64_t column = left; column <= right; ++column) blocks.emplace(row, column);
            if (blocks.size() > most) return false;
        }
        return true;
    }

    /// What cells near targets change, added to the region as it is far from them.
    Result<Evaluation> add_changes(const TexelRegion& region, const Budget& budget, const Evaluation& rest,
                                   LinearImage& out) const {
        const std::size_t most = most_blocks(budget.accuracy);
        Blocks blocks;
        if (!add_blocks(region, 0, most, blocks)) return leave_out(region, rest);
        Sums sums{.values = std::vector<std::int64_t>(out.values.size()),
                  .bounds = std::vector<double>(out.values.size() / 4),
                  .evaluation = rest};
        Blocks done;
        Validity seen;
        // Cells that are first reached so many steps from now change then: look ahead until some cell does
        for (Step ahead = 0, next = 1;;) {
            for (const auto& block : blocks) {
                if (!done.insert(block).second) continue;
                if (auto added = add_block(region, block, budget, sums, seen); !added) return added.error();
            }
            if (!moves() || looking_->one_grid) break;
            const bool later = seen.until > add_steps(region.step, ahead),
                       earlier = seen.from <= add_steps(region.step, -ahead);
            if ((!later && !earlier) || ahead >= round_) break;
            for (next = std::min(add_steps(ahead, std::max<Step>(ahead, 1)), round_);;
                 next = ahead + (next - ahead) / 2) {
                Blocks more = done;
                if (add_blocks(region, next, 2 * most, more)) {
                    blocks = std::move(more);
                    break;
                }
                if (next > ahead + 1) continue;
                // Further off than can be looked at: until then, nothing new comes near
                seen.meet({add_steps(region.step, -ahead), add_steps(region.step, ahead + 1)});
                next = round_;
                break;
            }
            ahead = next;
        }
        Evaluation all = sums.evaluation;
        all.validity.meet(seen);
        if (looking_->one_grid) narrow(middles_of(region), region.step, all.validity);
        if (!sums.any) return all;
        all.method = "targets";
        const double share = std::ldexp(1.0, -2 * (region.level - looking_->cell_log2));
        all.bound_codes += share * *std::max_element(sums.bounds.begin(), sums.bounds.end()) + rounding_codes;
        const double factor = share / sum_unit;
        for (std::size_t i = 0; i < sums.values.size(); ++i)
            if (sums.values[i] != 0)
                out.values[i] = static_cast<float>(
                    std::max(double{out.values[i]} + static_cast<double>(sums.values[i]) * factor, 0.0));
        return all;
    }

    struct Sums {
        std::vector<std::int64_t> values;
        std::vector<double> bounds;  ///< Of the sums of a texel's cells, in codes.
        Evaluation evaluation;
        bool any = false;
        LinearImage with{}, without{};
    };

    Result<void> add_block(const TexelRegion& region, std::pair<std::int64_t, std::int64_t> block,
                           const Budget& budget, Sums& sums, Validity& seen) const {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const int up = region.level - looking_->cell_log2;
        constexpr std::int64_t side = std::int64_t{1} << block_log2;
        const TexelBox box = common(
            {block.second * side, block.first * side, (block.second + 1) * side, (block.first + 1) * side},
            {region.x << up, region.y << up, (region.x + region.width) << up,
             (region.y + region.height) << up});
        TexelRegion fine = region;
        fine.level = static_cast<std::uint8_t>(looking_->cell_log2);
        fine.x = box.x0;
        fine.y = box.y0;
        fine.width = static_cast<std::int32_t>(box.x1 - box.x0);
        fine.height = static_cast<std::int32_t>(box.y1 - box.y0);
        const auto with = pattern_->evaluate(seeing(fine), budget, sums.with);
        if (!with) return with.error();
        seen.meet(with->validity);
        const auto without = pattern_->evaluate(fine, budget, sums.without);
        if (!without) return without.error();
        sums.evaluation.work += with->work + without->work;
        const double bound = with->bound_codes + without->bound_codes;
        for (std::int32_t y = 0; y < fine.height; ++y) {
            const float *now = sums.with.row(y), *rest = sums.without.row(y);
            const std::int64_t row = (((fine.y + y) >> up) - region.y) * region.width - region.x;
            for (std::int64_t x = 0; x < fine.width; ++x, now += 4, rest += 4) {
                if (std::equal(now, now + 4, rest)) continue;
                const auto texel = static_cast<std::size_t>(row + ((fine.x + x) >> up));
                for (std::size_t c = 0; c < 4; ++c) {
                    const double change = double{now[c]} - double{rest[c]};
                    sums.values[texel * 4 + c] +=
                        static_cast<std::int64_t>(change * sum_unit + (change < 0 ? -0.5 : 0.5));
                }
                sums.bounds[texel] += bound;
                sums.any = true;
            }
        }
        return {};
    }

    /// Too many cells: no texel is further off than its share that targets reach.
    Evaluation leave_out(const TexelRegion& region, Evaluation rest) const {
        const double area = std::ldexp(1.0, 2 * region.level);
        const auto across = static_cast<double>(2 * (looking_->reach + looking_->margin) + 1);
        const auto targets = static_cast<double>(distances_.laws.front().targets().size());
        rest.bound_codes = std::min(255.0, rest.bound_codes + 255 * targets * across * across / area);
        if (moves()) rest.validity.meet({region.step, add_steps(region.step, 1)});
        return rest;
    }

    std::shared_ptr<const Texture> pattern_;
    std::shared_ptr<const Looking> looking_;
    TargetDistances distances_;
    Step round_ = 0;  ///< Of the targets that move; 0: none does.
};

}  // namespace

std::shared_ptr<const Texture> make_targeted_texture(std::shared_ptr<const Texture> pattern, const Plan& plan,
                                                     std::span<const MovingTarget> targets) {
    auto looking = std::make_shared<const Looking>(looking_of(*pattern, plan));
    if (looking->laws.empty()) return pattern;
    return std::make_shared<TargetedTexture>(std::move(pattern), std::move(looking), targets);
}

std::shared_ptr<const Texture> with_targets(std::shared_ptr<const Texture> texture,
                                            std::span<const MovingTarget> targets) {
    const auto* now = dynamic_cast<const TargetedTexture*>(texture.get());
    if (now == nullptr) return texture;
    return std::make_shared<TargetedTexture>(now->pattern(), now->looking(), targets);
}

bool moved_by_targets(const Texture& texture) noexcept {
    const auto* targeted = dynamic_cast<const TargetedTexture*>(&texture);
    return targeted != nullptr && targeted->moves();
}

std::vector<TexelBox> texels_near(const Texture& texture, const MovingTarget& target) {
    const auto* targeted = dynamic_cast<const TargetedTexture*>(&texture);
    if (targeted == nullptr) return {};
    const std::int64_t grow = targeted->looking()->reach + targeted->looking()->margin;
    std::vector<TexelBox> boxes;
    const auto legs = target.legs();
    for (std::size_t i = 0; i < legs.size(); ++i) {
        const MotionPoint from = legs[i].from, to = legs[(i + 1) % legs.size()].from;
        boxes.push_back({std::min(from.x, to.x) - grow, std::min(from.y, to.y) - grow,
                         std::max(from.x, to.x) + grow + 1, std::max(from.y, to.y) + grow + 1});
    }
    return boxes;
}

}  // namespace tessera
