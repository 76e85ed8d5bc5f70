#include "server/pattern/layered_texture.h"

#include <algorithm>
#include <utility>

#include "server/pattern/descent.h"
#include "server/pattern/mean_products.h"

namespace tessera {
namespace {

class LayeredTexture final : public Texture, public Composite {
  public:
    LayeredTexture(std::vector<Layer> layers, const std::optional<DrawLaw>& law) {
        if (law) measured_.emplace(*this, *law);
        for (Layer& layer : layers) layers_.push_back({CompositePart{std::move(layer.texture)}, layer.range});
    }

    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        return evaluate_descending(*this, region, budget, out);
    }
    std::string_view kind() const noexcept override { return "layers"; }
    std::string description() const override {
        std::string text = std::to_string(layers_.size()) + " layers, composited where they are filtered";
        for (const Part& layer : layers_) text += "; " + layer.is.texture()->description();
        return text;
    }
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes = sizeof *this;
        for (const Part& layer : layers_) bytes += layer.is.texture()->memory_bytes();
        return bytes;
    }

    int parts() const noexcept override {
        int parts = 0;
        for (const Part& layer : layers_) parts += layer.is.parts();
        return parts;
    }
    const MeasuredError* measured() const noexcept override { return measured_ ? &*measured_ : nullptr; }
    Result<Evaluation> compose(const TexelRegion& region, const Budget& budget, LinearImage& out,
                               std::vector<float>& bounds) const override {
        return region.level == 0 ? compose_texels(region, budget, out, bounds)
                                 : compose_means(region, budget, out, bounds);
    }

  private:
    struct Part {
        CompositePart is;
        TexelRange range;
    };

    /// What the layers' own evaluations were, together.
    struct Sum {
        Evaluation evaluation{.method = "layers"};
        double doubt = 0;
        void add(const Evaluation& part) noexcept {
            evaluation.work += part.work;
            evaluation.bound_codes += part.bound_codes;
            doubt += 1 - part.confidence;
            evaluation.validity.meet(part.validity);
        }
        Evaluation total() const noexcept {
            Evaluation all = evaluation;
            all.confidence = std::max(1 - doubt, 0.0);
            return all;
        }
    };

    /// Level 0, where a texel is one value.
    Result<Evaluation> compose_texels(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                      std::vector<float>& bounds) const {
        Sum sum;
        LinearImage upper;
        std::vector<float> errors;
        for (std::size_t k = 0; k < layers_.size(); ++k) {
            const auto one =
                layers_[k].is.evaluate(region, budget, k == 0 ? out : upper, k == 0 ? bounds : errors);
            if (!one) return one;
            sum.add(*one);
            if (k == 0) continue;
            float* below = out.values.data();
            const float* over = upper.values.data();
            for (std::size_t i = 0; i < bounds.size(); ++i, over += 4, below += 4) {
                const float rest = 1 - over[3];
                for (std::size_t c = 0; c < 4; ++c) below[c] = over[c] + rest * below[c];
                bounds[i] += 2 * errors[i];  // In its colour, and in what its alpha leaves of those below
            }
        }
        return sum.total();
    }

    Result<Evaluation> compose_means(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                     std::vector<float>& bounds) const {
        Sum sum;
        const auto ground = layers_.front().is.evaluate(region, budget, out, bounds);
        if (!ground) return ground;
        sum.add(*ground);
        TexelRange range = layers_.front().range;
        const std::size_t texels = out.values.size() / 4;
        std::vector<KnownMeans> means(texels);
        for (std::size_t i = 0; i < texels; ++i)
            for (std::size_t c = 0; c < 4; ++c) {
                const float value = out.values[i * 4 + c];
                means[i].estimate[c] = value;
                means[i].least[c] = std::max(value - bounds[i], range.least[c]);
                means[i].most[c] = std::min(value + bounds[i], range.most[c]);
            }
        for (std::size_t k = 1; k < layers_.size(); ++k) {
            const auto upper = layers_[k].is.evaluate(region, budget, out, bounds);
            if (!upper) return upper;
            sum.add(*upper);
            const MeansOver over{layers_[k].range, range, false};
            for (std::size_t i = 0; i < texels; ++i) over(&out.values[i * 4], bounds[i], means[i]);
            range = over.range();
        }
        for (std::size_t i = 0; i < texels; ++i) {
            std::copy_n(means[i].estimate.begin(), 4, &out.values[i * 4]);
            bounds[i] = means[i].bound();
        }
        return sum.total();
    }

    std::vector<Part> layers_;
    std::optional<MeasuredError> measured_;
};

}  // namespace

std::shared_ptr<const Texture> make_layered_texture(std::vector<Layer> layers,
                                                    const std::optional<DrawLaw>& law) {
    if (layers.size() == 1) return layers.front().texture;
    return std::make_shared<LayeredTexture>(std::move(layers), law);
}

}  // namespace tessera
