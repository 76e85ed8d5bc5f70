#include "server/pattern/pixel_map_texture.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/pattern/descent.h"
#include "server/pattern/mean_products.h"
#include "server/pattern/sparse_map.h"

namespace tessera {
namespace {

class PixelMapTexture final : public Texture, public Composite {
  public:
    PixelMapTexture(const StoredMap& map, std::vector<Layer> parts, std::shared_ptr<const Texture> joint,
                    const std::optional<DrawLaw>& law)
        : map_{map, parts.size()},
          entry_log2_{map.cells_log2},
          range_{parts[map_.at(0, 0)].range},
          joint_{std::move(joint)} {
        if (law) measured_.emplace(*this, *law);
        for (Layer& part : parts) {
            if (part.texture) range_ = range_of_either(range_, part.range);
            parts_.push_back({CompositePart{std::move(part.texture)}, part.range});
        }
    }

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        if (const auto family = only_family(region)) return part(*family).evaluate(region, budget, out);
        if (joint_ && region.level > entry_log2_) return joint_->evaluate(region, budget, out);
        // Each texel one family's: only families that are composites themselves have to descend
        return evaluate_descending(*this, region, budget, out);
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (const auto family = only_family(region)) return part(*family).evaluate(region, budget, out);
        if (joint_ && region.level > entry_log2_) return joint_->evaluate(region, budget, out);
        return Texture::evaluate(region, budget, out);
    }
    std::string_view kind() const noexcept override { return "pixel_map"; }
    std::string description() const override {
        std::string text = "pixel map of " + std::to_string(std::int64_t{1} << entry_log2_) +
                           " texels an entry, " + std::to_string(map_.memory_bytes()) + " bytes";
        for (const Part& part : parts_)
            if (part.is.texture() != nullptr) text += "; " + part.is.texture()->description();
        return text;
    }
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes = sizeof *this + map_.memory_bytes();
        for (const Part& part : parts_)
            if (part.is.texture() != nullptr) bytes += part.is.texture()->memory_bytes();
        if (joint_) bytes += joint_->memory_bytes();
        return bytes;
    }

    /// Of the two families that most texels at a border show, the costlier ones.
    int parts() const noexcept override {
        int most = 1;
        for (const Part& part : parts_)
            if (part.is.texture() != nullptr) most = std::max(most, part.is.parts());
        return std::min(2 * most, 1 << 20);  // Pixel maps may lie in pixel maps
    }
    const MeasuredError* measured() const noexcept override { return measured_ ? &*measured_ : nullptr; }
    Result<Evaluation> compose(const TexelRegion& region, const Budget& budget, LinearImage& out,
                               std::vector<float>& bounds) const override {
        if (joint_ && region.level > entry_log2_) {
            const auto one = joint_->evaluate(region, budget, out);
            if (one)
                bounds.assign(out.values.size() / 4, static_cast<float>(one->bound_codes * code_in_linear));
            return one;
        }
        const Families families = families_in(region);
        out = LinearImage{region.width, region.height};
        bounds.assign(out.values.size() / 4, 0.0F);
        Evaluation sum{.method = "pixel map"};
        double doubt = 0;
        std::vector<KnownMeans> means(region.level > entry_log2_ ? bounds.size() : 0);
        for (std::size_t family = 0; family < parts_.size(); ++family) {
            if (!families.test(family)) continue;
            const std::vector<float> shares = shares_of(static_cast<std::uint8_t>(family), region);
            const auto one = add_part(family, region, budget, shares, out, bounds, means);
            if (!one) return one;
            sum.work += one->work;
            sum.bound_codes = std::max(sum.bound_codes, one->bound_codes);
            doubt += 1 - one->confidence;
            sum.validity.meet(one->validity);
        }
        for (std::size_t i = 0; i < means.size(); ++i) {
            KnownMeans& mean = means[i];
            for (std::size_t c = 0; c < 4; ++c) {
                mean.least[c] = std::max(mean.least[c], range_.least[c]);
                mean.most[c] = std::min(mean.most[c], range_.most[c]);
                out.values[i * 4 + c] = mean.estimate[c];
            }
            bounds[i] = mean.bound();
        }
        sum.confidence = std::max(1 - doubt, 0.0);
        return sum;
    }

  private:
    struct Part {
        CompositePart is;
        TexelRange range;
    };
    const Texture& part(std::size_t family) const noexcept { return *parts_[family].is.texture(); }

    Families families_in(const TexelRegion& region) const {
        const int up = region.level - entry_log2_;
        if (up >= 0) {
            const std::int64_t side = std::int64_t{1} << up;
            return map_.families_in(
                {region.x * side, region.y * side, region.width * side, region.height * side});
        }
        const std::int64_t x = region.x >> -up, y = region.y >> -up;
        return map_.families_in({x, y, ((region.x + region.width - 1) >> -up) - x + 1,
                                 ((region.y + region.height - 1) >> -up) - y + 1});
    }
    std::optional<std::size_t> only_family(const TexelRegion& region) const {
        const Families families = families_in(region);
        if (families.count() != 1) return std::nullopt;
        std::size_t family = 0;
        while (!families.test(family)) ++family;
        return family;
    }

    /// How much of each texel shows the family.
    std::vector<float> shares_of(std::uint8_t family, const TexelRegion& region) const {
        const int up = region.level - entry_log2_;
        if (up > 0) return map_.shares(family, up, region.x, region.y, region.width, region.height);
        std::vector<float> shares;
        shares.reserve(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
        for (std::int64_t y = region.y; y < region.y + region.height; ++y)
            for (std::int64_t x = region.x; x < region.x + region.width; ++x)
                shares.push_back(map_.at(x >> -up, y >> -up) == family ? 1.0F : 0.0F);
        return shares;
    }

    /// Evaluates a family where it shows, and adds what it gives to each texel.
    Result<Evaluation> add_part(std::size_t family, const TexelRegion& region, const Budget& budget,
                                const std::vector<float>& shares, LinearImage& out,
                                std::vector<float>& bounds, std::vector<KnownMeans>& means) const {
        std::int32_t left = region.width, right = 0, top = region.height, bottom = 0;
        for (std::int32_t y = 0; y < region.height; ++y)
            for (std::int32_t x = 0; x < region.width; ++x)
                if (shares[static_cast<std::size_t>(y * region.width + x)] > 0) {
                    left = std::min(left, x);
                    right = std::max(right, x + 1);
                    top = std::min(top, y);
                    bottom = y + 1;
                }
        if (left >= right) return Evaluation{};
        TexelRegion shown = region;
        shown.x += left;
        shown.y += top;
        shown.width = right - left;
        shown.height = bottom - top;
        LinearImage image;
        std::vector<float> errors;
        const auto one = parts_[family].is.evaluate(shown, budget, image, errors);
        if (!one) return one;

        const TexelRange& range = parts_[family].range;
        std::array<ProductLimits, 4> products;
        for (std::size_t c = 0; c < 4; ++c) products[c] = {0, 1, range.least[c], range.most[c]};
        for (std::int32_t y = top; y < bottom; ++y) {
            const float* texel = image.row(y - top);
            const float* errors_of = errors.data() + std::ptrdiff_t{y - top} * shown.width;
            for (std::int32_t x = left; x < right; ++x, texel += 4, ++errors_of) {
                const float error = *errors_of;
                const auto i = static_cast<std::size_t>(y * region.width + x);
                const float share = shares[i];
                if (share == 0) continue;
                if (means.empty()) {
                    std::copy_n(texel, 4, &out.values[i * 4]);
                    bounds[i] = error;
                    continue;
                }
                for (std::size_t c = 0; c < 4; ++c) {
                    means[i].estimate[c] += share * texel[c];
                    means[i].least[c] += products[c].least(share, texel[c] - error);
                    means[i].most[c] += products[c].most(share, texel[c] + error);
                }
            }
        }
        return one;
    }

    SparseMap map_;
    int entry_log2_;
    std::vector<Part> parts_;
    TexelRange range_;
    std::shared_ptr<const Texture> joint_;  ///< Null, or exact at every level.
    std::optional<MeasuredError> measured_;
};

}  // namespace

std::shared_ptr<const Texture> make_pixel_map_texture(const StoredMap& map, std::vector<Layer> parts,
                                                      std::shared_ptr<const Texture> joint,
                                                      const std::optional<DrawLaw>& law) {
    return std::make_shared<PixelMapTexture>(map, std::move(parts), std::move(joint), law);
}

}  // namespace tessera
