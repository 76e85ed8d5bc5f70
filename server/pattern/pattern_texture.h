#pragma once

#include <memory>

#include "server/blocks/plan.h"
#include "server/texture/texture.h"

namespace tessera {

struct PatternKept;

/// A texture made of cells, and what layers above or below it must know.
class PatternTexture : public Texture {
  public:
    /// From this level on a texel covers whole cells whose looks are drawn; −1 if nothing is drawn by chance.
    /// Bounds that hold with a confidence count cells with it.
    virtual int cell_level() const noexcept = 0;

    /// As evaluate(), for a composite that evaluates its parts several times for one page: cells are summed
    /// only where that costs little.
    virtual Result<Evaluation> evaluate_part(const TexelRegion& region, const Budget& budget,
                                             LinearImage& out) const {
        return evaluate(region, budget, out);
    }
};

/// Compiles the plan's textures, from parts to wholes.
/// `kept`: what can be taken over from an earlier compilation, and is kept for the next; null: nothing.
std::shared_ptr<const Texture> make_pattern_texture(const Plan& plan, PatternKept* kept = nullptr);

/// The most that it may take when it is compiled, in bytes: what loading checks before it allocates.
std::size_t pattern_bytes(const Plan& plan);

}  // namespace tessera
