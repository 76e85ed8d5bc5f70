#include "server/texture/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "server/texture/lean.h"

namespace tessera {
namespace {

using TexturePtr = std::shared_ptr<const Texture>;

/// Up to three filtered textures of numbers, made into one set's texels, row by row.
class MaterialTexture : public Texture {
  public:
    static constexpr std::size_t most_sources = 3;
    using Rows =
        std::array<const float*, most_sources>;       ///< RGBA of each source, in the order they were given.
    using Errors = std::array<double, most_sources>;  ///< Of each source at most, in parts of 1.

    MaterialTexture(ChannelSet set, std::vector<TexturePtr> sources, std::size_t own_bytes)
        : set_{set}, sources_{std::move(sources)}, own_bytes_{own_bytes} {}

    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        std::array<LinearImage, most_sources> in;
        Errors errors{};
        Evaluation all;
        const std::size_t used = sources_used(region.level);
        for (std::size_t i = 0; i < used; ++i) {
            const auto one = sources_[i]->evaluate(region, budget, in[i]);
            if (!one) return one.error();
            errors[i] = one->bound_codes * code_in_linear;
            all.method = one->method;
            all.confidence = std::min(all.confidence, one->confidence);
            all.work += one->work;
        }
        out = LinearImage{region.width, region.height};
        for (std::int32_t y = 0; y < region.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            Rows rows{};
            for (std::size_t i = 0; i < used; ++i) rows[i] = in[i].row(y);
            all.bound_codes =
                std::max(all.bound_codes, fill_row(rows, errors, region.level, region.width, out.row(y)));
        }
        return all;
    }
    TexelKind texel_kind() const noexcept override { return TexelKind::data; }
    std::string_view kind() const noexcept override { return name_of(set_); }
    std::string description() const override { return std::string{name_of(set_)} + ": " + words(); }
    std::size_t memory_bytes() const noexcept override { return own_bytes_; }

  protected:
    /// How many of the sources, the first ones, fill_row() looks at on a level.
    virtual std::size_t sources_used(int) const noexcept { return sources_.size(); }
    /// Fills a row of `width` RGBA texels of `level`, and tells how many codes it is off at most.
    virtual double fill_row(const Rows& in, const Errors& errors, int level, std::int32_t width,
                            float* out) const = 0;
    virtual std::string words() const = 0;

    static void put(float* texel, double red, double green, double blue) noexcept {
        texel[0] = static_cast<float>(red);
        texel[1] = static_cast<float>(green);
        texel[2] = static_cast<float>(blue);
        texel[3] = 1.0F;
    }

  private:
    ChannelSet set_;
    std::vector<TexturePtr> sources_;
    std::size_t own_bytes_;
};

std::string range_text(double range) {
    char text[64];
    std::snprintf(text, sizeof text, "slopes within ±%.3f", range);
    return text;
}

/// Filtered lean_slopes(), lean_squares() and lean_products().
struct LeanTextures {
    TexturePtr slopes, squares, products;
    double range = 0;
};

class NormalTexture final : public MaterialTexture {
  public:
    explicit NormalTexture(const LeanTextures& lean)
        : MaterialTexture{ChannelSet::normal, {lean.slopes}, lean.slopes->memory_bytes()},
          range_{lean.range} {}

  private:
    double fill_row(const Rows& in, const Errors& errors, int, std::int32_t width,
                    float* out) const override {
        for (std::int32_t x = 0; x < width; ++x) {
            const Slopes mean = lean_mean(in[0] + 4 * x, range_);
            const double half = 0.5 / std::sqrt(mean.x * mean.x + mean.y * mean.y + 1.0);
            put(out + 4 * x, 0.5 + mean.x * half, 0.5 + mean.y * half, 0.5 + half);
        }
        // A normal moves by no more than its slopes do, which are 2·range wide, and is coded at half its size
        return 255 * 1.4143 * range_ * errors[0];
    }
    std::string words() const override { return "unit normals of the mean slopes, " + range_text(range_); }

    double range_;
};

class RoughnessTexture final : public MaterialTexture {
  public:
    /// Of a surface without normals: squared_alphas().
    explicit RoughnessTexture(const TexturePtr& alphas)
        : MaterialTexture{ChannelSet::roughness, {alphas}, alphas->memory_bytes()} {}
    explicit RoughnessTexture(const LeanTextures& lean)
        : MaterialTexture{ChannelSet::roughness, {lean.products, lean.slopes, lean.squares}, 0},
          range_{lean.range} {}

  private:
    std::size_t sources_used(int level) const noexcept override { return range_ > 0 && level > 0 ? 3 : 1; }
    double fill_row(const Rows& in, const Errors& errors, int level, std::int32_t width,
                    float* out) const override {
        const bool bumpy = range_ > 0 && level > 0;
        double least = 1;
        for (std::int32_t x = 0; x < width; ++x) {
            const std::int32_t at = 4 * x;
            const LeanTexel texel =
                bumpy ? lean_texel(in[1] + at, in[2] + at, in[0] + at, range_) : LeanTexel{};
            const double roughness = rougher(squared_alpha(in[0] + at), texel);
            least = std::min(least, roughness);
            put(out + at, roughness, roughness, roughness);
        }
        double error = squared_alpha_error(errors[0]);
        if (bumpy) error += lean_error(*std::max_element(errors.begin(), errors.end()), range_).trace;
        // The root is steepest where the row is smoothest, and steeper yet below
        const double squared = least * least * least * least;
        const double above = roughness_of(squared + error) - least;
        const double below = least - roughness_of(std::max(0.0, squared - error));
        return 255 * std::max(above, below);
    }
    std::string words() const override {
        return range_ > 0 ? "with the spread of the normals under a texel, " + range_text(range_)
                          : "no normals: filtered as the variance it stands for";
    }

    double range_ = 0;  ///< 0: there are no normals.
};

/// The third value of a source.
class HeightTexture final : public MaterialTexture {
  public:
    HeightTexture(const TexturePtr& source, bool owns)
        : MaterialTexture{ChannelSet::height, {source}, owns ? source->memory_bytes() : 0} {}

  private:
    double fill_row(const Rows& in, const Errors& errors, int, std::int32_t width,
                    float* out) const override {
        for (std::int32_t x = 0; x < width; ++x) {
            const float height = in[0][4 * x + 2];
            put(out + 4 * x, height, height, height);
        }
        return 255 * errors[0];
    }
    std::string words() const override { return "linear"; }
};

/// Roots: variances of 8 bits would leave nothing of a gentle bump.
class MomentsTexture final : public MaterialTexture {
  public:
    explicit MomentsTexture(const LeanTextures& lean)
        : MaterialTexture{ChannelSet::moments,
                          {lean.slopes, lean.squares, lean.products},
                          lean.squares->memory_bytes() + lean.products->memory_bytes()},
          range_{lean.range} {}

  private:
    /// One tells how level 0 is made, and stops with the budget.
    std::size_t sources_used(int level) const noexcept override { return level > 0 ? 3 : 1; }
    double fill_row(const Rows& in, const Errors& errors, int level, std::int32_t width,
                    float* out) const override {
        for (std::int32_t x = 0; x < width; ++x) {
            const std::int32_t at = 4 * x;
            const LeanTexel texel =
                level > 0 ? lean_texel(in[0] + at, in[1] + at, in[2] + at, range_) : LeanTexel{};
            const double root = std::copysign(std::sqrt(std::abs(texel.covariance)), texel.covariance);
            put(out + at, std::min(1.0, std::sqrt(texel.variance_x)),
                std::min(1.0, std::sqrt(texel.variance_y)), 0.5 + 0.5 * std::clamp(root, -1.0, 1.0));
        }
        if (level == 0) return 0;
        // The root of something small is off by the root of its error
        const LeanError error = lean_error(*std::max_element(errors.begin(), errors.end()), range_);
        return 255 * std::sqrt(std::max(error.variance, error.covariance));
    }
    std::string words() const override {
        return "σx, σy and the signed root of the covariance of the normals under a texel, " +
               range_text(range_);
    }

    double range_;
};

const ExchangeAsset::Channel* image_of(const ExchangeAsset& asset, ChannelSet set) noexcept {
    for (const ExchangeAsset::Channel& channel : asset.channels)
        if (channel.name == name_of(set)) return &channel;
    return nullptr;
}

Rgb16Image greys(const Rgb8Image& image) {
    Rgb16Image wide{image.width, image.height, {}};
    wide.values.reserve(image.bytes.size());
    for (const std::uint8_t byte : image.bytes) wide.values.push_back(static_cast<std::uint16_t>(byte * 257));
    return wide;
}

}  // namespace

std::size_t channel_textures(const ExchangeAsset& asset) noexcept {
    const bool normal = image_of(asset, ChannelSet::normal) != nullptr,
               roughness = image_of(asset, ChannelSet::roughness) != nullptr,
               height = image_of(asset, ChannelSet::height) != nullptr;
    return normal ? 3 : roughness || height ? 1 : 0;
}

std::vector<Channels> make_channels(const std::shared_ptr<const ExchangeTexture>& albedo,
                                    const ExchangeAsset& asset) {
    const auto* normal = image_of(asset, ChannelSet::normal);
    const auto* roughness = image_of(asset, ChannelSet::roughness);
    const auto* height = image_of(asset, ChannelSet::height);
    const auto filtered = [&](const auto& texels_of) {
        return albedo->with_texels(texels_of(&ExchangeAsset::Channel::exemplar),
                                   texels_of(&ExchangeAsset::Channel::tile));
    };
    using Part = Rgb8Image ExchangeAsset::Channel::*;
    const auto part_of = [](const ExchangeAsset::Channel* channel, Part part) {
        return channel == nullptr ? nullptr : &(channel->*part);
    };

    // Heights travel in the third value of whichever texture there is
    LeanTextures lean;
    TexturePtr alphas, heights;
    if (normal != nullptr) {
        const double range = lean.range = std::max(steepest_in(normal->exemplar), steepest_in(normal->tile));
        lean.slopes = heights =
            filtered([&](Part part) { return lean_slopes(normal->*part, range, part_of(height, part)); });
        lean.squares = filtered([&](Part part) { return lean_squares(normal->*part, range); });
        lean.products = filtered(
            [&](Part part) { return lean_products(normal->*part, range, part_of(roughness, part)); });
    } else if (roughness != nullptr) {
        alphas = heights =
            filtered([&](Part part) { return squared_alphas(roughness->*part, part_of(height, part)); });
    } else if (height != nullptr) {
        heights = filtered([&](Part part) { return greys(height->*part); });
    }

    std::vector<Channels> sets;
    const auto add = [&](ChannelSet set, TexturePtr texture) { sets.push_back({set, std::move(texture)}); };
    if (normal != nullptr) add(ChannelSet::normal, std::make_shared<NormalTexture>(lean));
    if (roughness != nullptr)
        add(ChannelSet::roughness, normal != nullptr ? std::make_shared<RoughnessTexture>(lean)
                                                     : std::make_shared<RoughnessTexture>(alphas));
    if (height != nullptr)
        add(ChannelSet::height,
            std::make_shared<HeightTexture>(heights, normal == nullptr && roughness == nullptr));
    if (normal != nullptr) add(ChannelSet::moments, std::make_shared<MomentsTexture>(lean));
    return sets;
}

}  // namespace tessera
