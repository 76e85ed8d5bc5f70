#pragma once

#include <algorithm>

#include "server/texture/texture.h"

namespace tessera::test {

/// Grey by its accuracy, with a bound of 4 codes (fast), 1 (high) and 0.25 (exact).
class SteppedTexture final : public Texture {
  public:
    using Texture::evaluate;

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        const bool fast = budget.accuracy == Accuracy::fast, exact = budget.accuracy == Accuracy::exact;
        out = LinearImage{region.width, region.height};
        std::fill(out.values.begin(), out.values.end(), fast ? 0.1F : exact ? 0.9F : 0.5F);
        Evaluation did;
        did.method = name_of(budget.accuracy);
        did.bound_codes = fast ? 4 : exact ? 0.25 : 1;
        did.confidence = exact ? 1 : 0.99;
        did.work = 10;
        return did;
    }
    std::string_view kind() const noexcept override { return "stepped"; }
    std::string description() const override { return "stepped"; }
    std::size_t memory_bytes() const noexcept override { return 0; }
};

}  // namespace tessera::test
