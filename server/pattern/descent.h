#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "server/pattern/measured_error.h"
#include "server/pattern/pattern_texture.h"
#include "server/texture/texture.h"

namespace tessera {

/// A texture put together from parts whose products do not commute with the box filter: its texels at a level
/// are estimates, each with its own certain bound; at level 0 they are exact.
class Composite {
  public:
    virtual ~Composite() = default;
    /// `bounds`: for each texel of `region`, in linear light, rows from the top. The evaluation's bound_codes
    /// says how much of them is the parts' own, which no descent mends.
    virtual Result<Evaluation> compose(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                       std::vector<float>& bounds) const = 0;
    /// Descents that stay above this level mend nothing.
    virtual int mended_from() const noexcept { return max_level; }
    /// What a texel costs: layers, instances that may meet.
    virtual int parts() const noexcept = 0;
    /// How far compositions are off, measured; null where it is not known how things are drawn.
    virtual const MeasuredError* measured() const noexcept { return nullptr; }
};

/// A part of a composite: a texture, or a composite itself, which is then composed at the level of the whole,
/// with its texels' own bounds; only the whole descends.
class CompositePart {
  public:
    explicit CompositePart(std::shared_ptr<const Texture> texture)
        : texture_{std::move(texture)},
          composite_{dynamic_cast<const Composite*>(texture_.get())},
          cells_{dynamic_cast<const PatternTexture*>(texture_.get())} {}
    CompositePart() = default;

    /// `bounds`: as Composite::compose gives them.
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                std::vector<float>& bounds) const;
    int parts() const noexcept { return composite_ != nullptr ? composite_->parts() : 1; }
    const Texture* texture() const noexcept { return texture_.get(); }

  private:
    std::shared_ptr<const Texture> texture_;
    const Composite* composite_ = nullptr;
    const PatternTexture* cells_ = nullptr;
};

/// Evaluates a composite, and where a block's bound is above half a code composes it d levels below and
/// reduces: estimates of smaller texels are products of less. fast: d = 0; high: up to 2; exact: as deep as a
/// certain half code needs, at most until a texel has cost 256 parts; not where a corner of
/// the block shows that the bound would shrink by less than a fifth. Where errors are measured, exact goes as
/// deep as a measured half code needs, or to where least is left, and states the least of both bounds. Blocks
/// lie on the level's lattice, so that a texel does not depend on the region that it was asked for in.
Result<Evaluation> evaluate_descending(const Composite& composite, const TexelRegion& region,
                                       const Budget& budget, LinearImage& out);

}  // namespace tessera
