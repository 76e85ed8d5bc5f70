#include "server/sprites/sprite_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "server/pattern/instance_images.h"

namespace tessera {
namespace {

/// Changes are summed in these parts of linear light: 2^30 texels of any change stay below 2^62.
constexpr double sum_unit = 0x1p32;
/// A float's rounding where a sprite is laid over, a few times; and that of a sum.
constexpr double rounding_codes = 1e-4;
/// Sprites are looked for, and the ground is evaluated, in stretches of such blocks of level 0.
constexpr int block_log2 = 5;
constexpr std::int32_t most_blocks_in_stretch = 32;

/// More sprites are not compared with each other, to see what they hide.
constexpr std::size_t most_compared_sprites = std::size_t{1} << 16;

/// Blocks [from, to) of a row of blocks.
struct Stretch {
    std::int64_t row = 0, from = 0, to = 0;
};

TexelBox level_0_box(const TexelRegion& region) noexcept {
    const std::int64_t side = std::int64_t{1} << region.level;
    return {region.x * side, region.y * side, (region.x + region.width) * side,
            (region.y + region.height) * side};
}

TexelBox common(const TexelBox& a, const TexelBox& b) noexcept {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

TexelSpan within(TexelSpan span, std::int64_t first, std::int32_t count) noexcept {
    return {std::max(span.from, first), std::min(span.to, first + count)};
}

std::int64_t most_blocks(Accuracy accuracy) noexcept {
    switch (accuracy) {
        case Accuracy::exact:
            return std::int64_t{1} << (24 - 2 * block_log2);
        case Accuracy::high:
            return std::int64_t{1} << (22 - 2 * block_log2);
        case Accuracy::fast:
            break;
    }
    return std::int64_t{1} << (20 - 2 * block_log2);
}

/// The blocks that boxes meet, each once, row by row. Empty, though boxes are not, if there are more than
/// `most`.
std::vector<Stretch> blocks_of(const std::vector<TexelBox>& boxes, std::int64_t most) {
    std::vector<std::pair<std::int64_t, std::int64_t>> blocks;  // row, column
    for (const TexelBox& box : boxes) {
        const std::int64_t left = box.x0 >> block_log2, right = (box.x1 - 1) >> block_log2;
        const std::int64_t top = box.y0 >> block_log2, bottom = (box.y1 - 1) >> block_log2;
        // Overlapping sprites share blocks, so that the list may be longer than what is left of it
        if ((right - left + 1) * (bottom - top + 1) > most) return {};
        for (std::int64_t row = top; row <= bottom; ++row)
            for (std::int64_t column = left; column <= right; ++column) blocks.emplace_back(row, column);
        if (static_cast<std::int64_t>(blocks.size()) <= 4 * most) continue;
        std::sort(blocks.begin(), blocks.end());
        blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
        if (static_cast<std::int64_t>(blocks.size()) > most) return {};
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    if (static_cast<std::int64_t>(blocks.size()) > most) return {};
    std::vector<Stretch> stretches;
    for (const auto& [row, column] : blocks) {
        if (!stretches.empty() && stretches.back().row == row && stretches.back().to == column &&
            column - stretches.back().from < most_blocks_in_stretch)
            ++stretches.back().to;
        else
            stretches.push_back({row, column, column + 1});
    }
    return stretches;
}

class SpriteTexture final : public PatternTexture {
  public:
    SpriteTexture(std::shared_ptr<const Texture> ground, std::shared_ptr<const SpriteImages> images,
                  PositioningMap sprites)
        : ground_{std::move(ground)}, images_{std::move(images)}, sprites_{std::move(sprites)} {}

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        Result<Evaluation> ground = ground_->evaluate(region, budget, out);
        if (!ground || !sprites_.any_meets(level_0_box(region))) return ground;
        return add_sprites(region, budget, *ground, out);
    }

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (!sprites_.any_meets(level_0_box(region))) return ground_->evaluate(region, budget, out);
        LinearImage linear;
        Result<Evaluation> done = evaluate(region, budget, linear);
        if (done) encode(linear, out);
        return done;
    }

    std::string_view kind() const noexcept override { return ground_->kind(); }
    int cell_level() const noexcept override {
        const auto* cells = dynamic_cast<const PatternTexture*>(ground_.get());
        return cells ? cells->cell_level() : -1;
    }
    std::string description() const override {
        return std::to_string(sprites_.size()) + " sprites of " + std::to_string(images_->count()) +
               " patterns over: " + ground_->description();
    }
    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + ground_->memory_bytes() + images_->memory_bytes() + sprites_.memory_bytes();
    }

  private:
    Result<Evaluation> add_sprites(const TexelRegion& region, const Budget& budget, const Evaluation& ground,
                                   LinearImage& out) const {
        const TexelBox box = level_0_box(region);
        // What is elsewhere now may come, and what is here may go
        Evaluation done = ground;
        std::vector<Sprite> met = sprites_.meeting(box);
        for (const Sprite& sprite : met) done.validity.meet(stay_of(sprite, region.step));
        std::erase_if(met, [&](const Sprite& sprite) { return !box_at(sprite, region.step).meets(box); });
        if (met.empty()) return done;
        done.method = "sprites";
        if (region.level == 0) {
            for (const Sprite& sprite : met) lay_over(sprite, region, out);
            done.bound_codes += rounding_codes;
            done.work += met.size();
            return done;
        }
        std::vector<TexelBox> boxes;
        for (const Sprite& sprite : met) boxes.push_back(common(box_at(sprite, region.step), box));
        const std::vector<Stretch> stretches = blocks_of(boxes, most_blocks(budget.accuracy));
        return stretches.empty() ? lay_over_means(region, met, budget, done, out)
                                 : add_changes(region, box, stretches, budget, done, out);
    }

    /// Premultiplied over, level 0.
    void lay_over(const Sprite& sprite, const TexelRegion& region, LinearImage& out) const {
        const SpriteImage drawn = images_->of(sprite, region.slice, region.step);
        const TexelBox box = common(
            common(level_0_box(region), box_at(sprite, region.step)),
            {drawn.left, drawn.top, drawn.left + drawn.image->width(), drawn.top + drawn.image->height()});
        if (box.empty()) return;
        std::vector<float> row(static_cast<std::size_t>(box.x1 - box.x0) * 4);
        for (std::int64_t y = box.y0; y < box.y1; ++y) {
            instance_row(*drawn.image, drawn.left, drawn.top, 0, y, box.x0, box.x1, row.data());
            float* texel = out.row(static_cast<std::int32_t>(y - region.y)) + (box.x0 - region.x) * 4;
            for (std::size_t i = 0; i < row.size(); i += 4, texel += 4)
                for (std::size_t c = 0; c < 4; ++c) texel[c] = row[i + c] + (1.0F - row[i + 3]) * texel[c];
        }
    }

    /// What sprites change of their own texels of level 0, added to the ground of the region's level.
    Result<Evaluation> add_changes(const TexelRegion& region, const TexelBox& box,
                                   const std::vector<Stretch>& stretches, const Budget& budget,
                                   Evaluation done, LinearImage& out) const {
        std::vector<std::int64_t> sums(out.values.size());
        LinearImage before, after;
        double ground_bound = 0;
        for (const Stretch& stretch : stretches) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const TexelBox part = common(box, {stretch.from << block_log2, stretch.row << block_log2,
                                               stretch.to << block_log2, (stretch.row + 1) << block_log2});
            const TexelRegion fine{.level = 0,
                                   .x = part.x0,
                                   .y = part.y0,
                                   .width = static_cast<std::int32_t>(part.x1 - part.x0),
                                   .height = static_cast<std::int32_t>(part.y1 - part.y0),
                                   .slice = region.slice,
                                   .step = region.step,
                                   .parameter = region.parameter};
            const Result<Evaluation> evaluated = ground_->evaluate(fine, budget, before);
            if (!evaluated) return evaluated;
            ground_bound = std::max(ground_bound, evaluated->bound_codes);
            done.confidence = std::min(done.confidence, evaluated->confidence);
            done.validity.meet(evaluated->validity);
            after = before;
            for (const Sprite& sprite : sprites_.meeting_at(part, region.step)) lay_over(sprite, fine, after);
            add_difference(region, fine, before, after, sums);
            done.work += static_cast<std::uint64_t>(fine.width) * static_cast<std::uint64_t>(fine.height);
        }
        const double factor = 1.0 / (sum_unit * std::ldexp(1.0, 2 * region.level));
        for (std::size_t i = 0; i < sums.size(); ++i)
            if (sums[i] != 0)
                out.values[i] = static_cast<float>(
                    std::max(double{out.values[i]} + static_cast<double>(sums[i]) * factor, 0.0));
        done.bound_codes += ground_bound + rounding_codes;
        return done;
    }

    static void add_difference(const TexelRegion& region, const TexelRegion& fine, const LinearImage& before,
                               const LinearImage& after, std::vector<std::int64_t>& sums) noexcept {
        for (std::int32_t y = 0; y < fine.height; ++y) {
            const float* old_texel = before.row(y);
            const float* new_texel = after.row(y);
            std::int64_t* row = sums.data() + (((fine.y + y) >> region.level) - region.y) * region.width * 4;
            for (std::int64_t x = 0; x < fine.width; ++x, old_texel += 4, new_texel += 4) {
                std::int64_t* sum = row + (((fine.x + x) >> region.level) - region.x) * 4;
                for (std::size_t c = 0; c < 4; ++c) {
                    const double change = double{new_texel[c]} - double{old_texel[c]};
                    sum[c] += static_cast<std::int64_t>(change * sum_unit + (change < 0 ? -0.5 : 0.5));
                }
            }
        }
    }

    /// Sprites over the texel's mean ground. What they show is right but for what they hide of each other, at
    /// most where their boxes overlap. What they hide of the ground is a part of its sum: between 0 and the
    /// smaller of the ground and the share of the texel that they cover.
    Result<Evaluation> lay_over_means(const TexelRegion& region, const std::vector<Sprite>& met,
                                      const Budget& budget, Evaluation done, LinearImage& out) const {
        std::vector<float> sums(out.values.size());
        for (std::size_t n = 0; n < met.size(); ++n) {
            if (n % 64 == 0)
                if (auto spent = check_budget(budget); !spent) return spent.error();
            add_means(met[n], region, sums);
        }
        Result<std::vector<float>> overlaps = overlaps_of(met, region, budget);
        if (!overlaps) return overlaps.error();
        double bound = 0;
        for (std::size_t i = 0; i < sums.size(); i += 4) {
            const float covered = std::min(sums[i + 3], 1.0F);
            if (covered == 0) continue;
            // At more than full cover, as if all sprites were one layer
            const float thinned = sums[i + 3] > 1 ? 1 / sums[i + 3] : 1.0F;
            const float overlap = (*overlaps)[i / 4];
            for (std::size_t c = 0; c < 4; ++c) {
                const float ground = out.values[i + c];
                out.values[i + c] = sums[i + c] * thinned + (1 - covered) * ground;
                const float hidden = covered * ground, hidden_most = std::min(covered, ground);
                bound = std::max(bound, double{std::min({sums[i + c], overlap, 1.0F})} +
                                            double{std::max(hidden, hidden_most - hidden)});
            }
        }
        done.bound_codes = std::min(done.bound_codes + bound / code_in_linear + rounding_codes, 255.0);
        done.work += met.size();
        return done;
    }

    void add_means(const Sprite& sprite, const TexelRegion& region, std::vector<float>& sums) const {
        const SpriteImage drawn = images_->of(sprite, region.slice, region.step);
        const TexelSpan columns =
            within(texels_met(drawn.left, drawn.image->width(), region.level), region.x, region.width);
        const TexelSpan rows =
            within(texels_met(drawn.top, drawn.image->height(), region.level), region.y, region.height);
        if (columns.from >= columns.to) return;
        std::vector<float> row(static_cast<std::size_t>(columns.to - columns.from) * 4);
        for (std::int64_t y = rows.from; y < rows.to; ++y) {
            instance_row(*drawn.image, drawn.left, drawn.top, region.level, y, columns.from, columns.to,
                         row.data());
            float* sum = sums.data() + ((y - region.y) * region.width + columns.from - region.x) * 4;
            for (std::size_t i = 0; i < row.size(); ++i) sum[i] += row[i];
        }
    }

    /// Which share of each texel lies in the boxes of two sprites, each pair counted: at least what sprites
    /// hide of each other. All of it where there are too many to look at pairs.
    Result<std::vector<float>> overlaps_of(const std::vector<Sprite>& met, const TexelRegion& region,
                                           const Budget& budget) const {
        const auto texels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
        if (met.size() > most_compared_sprites) return std::vector<float>(texels, 1.0F);
        std::vector<float> overlaps(texels);
        const double side = std::ldexp(1.0, region.level);
        for (std::size_t n = 0; n < met.size(); ++n) {
            if (n % 64 == 0)
                if (auto spent = check_budget(budget); !spent) return spent.error();
            const TexelBox box = box_at(met[n], region.step);
            for (const Sprite& above : sprites_.meeting_at(box, region.step)) {
                if (!drawn_before(met[n], above)) continue;
                const TexelBox both = common(common(box, box_at(above, region.step)), level_0_box(region));
                if (both.empty()) continue;
                for (std::int64_t y = both.y0 >> region.level; y <= (both.y1 - 1) >> region.level; ++y)
                    for (std::int64_t x = both.x0 >> region.level; x <= (both.x1 - 1) >> region.level; ++x) {
                        const TexelBox part = common(
                            both,
                            level_0_box({.level = region.level, .x = x, .y = y, .width = 1, .height = 1}));
                        overlaps[static_cast<std::size_t>((y - region.y) * region.width + x - region.x)] +=
                            static_cast<float>(static_cast<double>(part.x1 - part.x0) / side *
                                               (static_cast<double>(part.y1 - part.y0) / side));
                    }
            }
        }
        return overlaps;
    }

    std::shared_ptr<const Texture> ground_;
    std::shared_ptr<const SpriteImages> images_;
    PositioningMap sprites_;
};

}  // namespace

std::shared_ptr<const PatternTexture> make_sprite_texture(std::shared_ptr<const Texture> ground,
                                                          std::shared_ptr<const SpriteImages> images,
                                                          PositioningMap sprites) {
    return std::make_shared<SpriteTexture>(std::move(ground), std::move(images), std::move(sprites));
}

}  // namespace tessera
