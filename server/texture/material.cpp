#include "server/texture/material.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include "server/texture/channel_data.h"
#include "server/texture/lean.h"

namespace tessera {
namespace {

using DataPtr = std::shared_ptr<const ExchangeData>;

/// Filtered images of numbers, up to three of them, made into one set's texels, row by row.
class MaterialTexture : public Texture {
  public:
    MaterialTexture(ChannelSet set, DataPtr data) : set_{set}, data_{std::move(data)} {}

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        out = LinearImage{region.width, region.height};
        return fill(region, budget,
                    [&](std::int32_t x, std::int32_t y, const float* rgba, std::int32_t width) {
                        std::copy_n(rgba, std::ptrdiff_t{width} * 4, out.row(y) + std::ptrdiff_t{x} * 4);
                    });
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (out.width != region.width || out.height != region.height)
            out = Rgba8Image{region.width, region.height};
        return fill(region, budget,
                    [&](std::int32_t x, std::int32_t y, const float* rgba, std::int32_t width) {
                        encode_data(rgba, std::size_t(width) * 4, out.row(y) + std::ptrdiff_t{x} * 4);
                    });
    }
    TexelKind texel_kind() const noexcept override { return TexelKind::data; }
    std::string_view kind() const noexcept override { return name_of(set_); }
    std::string description() const override { return std::string{name_of(set_)} + ": " + words(); }
    /// All sets of an asset share the data: make_channels() counts it to the first.
    std::size_t memory_bytes() const noexcept override { return counts_data_ ? data_->memory_bytes() : 0; }
    void count_data() noexcept { counts_data_ = true; }

  protected:
    /// Three values a texel of each image of images_for(level).
    using Rows = const float* const*;

    /// The images that fill_row() looks at on a level.
    virtual std::span<const std::size_t> images_for(int level) const noexcept = 0;
    /// Fills a row of `width` RGBA texels of `level`, and returns the least red value.
    virtual double fill_row(Rows in, int level, std::int32_t width, float* out) const = 0;
    /// How many codes texels of `level` are off at most, if no value of `in` is off by more than `error`, a
    /// part of 1, and `least` is their least red value.
    virtual double bound_codes(double error, int level, double least) const = 0;
    virtual std::string words() const = 0;

    static void put(float* texel, double red, double green, double blue) noexcept {
        texel[0] = static_cast<float>(red);
        texel[1] = static_cast<float>(green);
        texel[2] = static_cast<float>(blue);
        texel[3] = 1.0F;
    }

  private:
    template <class Put>
    Result<Evaluation> fill(const TexelRegion& region, const Budget& budget, const Put& put_row) const {
        std::vector<float> rgba(std::size_t(region.width) * 4);
        double least = 1;
        auto evaluation =
            data_->evaluate(region, budget, images_for(region.level),
                            [&](std::int32_t x, std::int32_t y, std::int32_t width, const float* const* in) {
                                least = std::min(least, fill_row(in, region.level, width, rgba.data()));
                                put_row(x, y, rgba.data(), width);
                            });
        if (evaluation)
            evaluation->bound_codes =
                bound_codes(evaluation->bound_codes * code_in_linear, region.level, least);
        return evaluation;
    }

    ChannelSet set_;
    DataPtr data_;
    bool counts_data_ = false;
};

std::string range_text(double range) {
    char text[64];
    std::snprintf(text, sizeof text, "slopes within ±%.3f", range);
    return text;
}

/// The images of make_channel_data().
constexpr std::size_t slopes = 0, squares = 1, products = 2, first_image = 0;

class NormalTexture final : public MaterialTexture {
  public:
    NormalTexture(DataPtr data, double range)
        : MaterialTexture{ChannelSet::normal, std::move(data)}, range_{range} {}

  private:
    std::span<const std::size_t> images_for(int) const noexcept override {
        static constexpr std::size_t images[] = {slopes};
        return images;
    }
    double fill_row(Rows in, int, std::int32_t width, float* out) const override {
        for (std::int32_t x = 0; x < width; ++x) {
            const Slopes mean = lean_mean(in[0] + 3 * x, range_);
            const double half = 0.5 / std::sqrt(mean.x * mean.x + mean.y * mean.y + 1.0);
            put(out + 4 * x, 0.5 + mean.x * half, 0.5 + mean.y * half, 0.5 + half);
        }
        return 0;
    }
    double bound_codes(double error, int, double) const override {
        // A normal moves by no more than its slopes do, which are 2·range wide, and is coded at half its size
        return 255 * 1.4143 * range_ * error;
    }
    std::string words() const override { return "unit normals of the mean slopes, " + range_text(range_); }

    double range_;
};

class RoughnessTexture final : public MaterialTexture {
  public:
    /// `range` 0: of a surface without normals.
    RoughnessTexture(DataPtr data, double range)
        : MaterialTexture{ChannelSet::roughness, std::move(data)}, range_{range} {}

  private:
    bool bumpy(int level) const noexcept { return range_ > 0 && level > 0; }
    std::span<const std::size_t> images_for(int level) const noexcept override {
        static constexpr std::size_t alphas[] = {first_image}, smooth[] = {products},
                                     all[] = {products, slopes, squares};
        if (bumpy(level)) return all;
        if (range_ > 0) return smooth;
        return alphas;
    }
    double fill_row(Rows in, int level, std::int32_t width, float* out) const override {
        double least = 1;
        for (std::int32_t x = 0; x < width; ++x) {
            const std::int32_t at = 3 * x;
            const LeanTexel texel =
                bumpy(level) ? lean_texel(in[1] + at, in[2] + at, in[0] + at, range_) : LeanTexel{};
            const double roughness = rougher(squared_alpha(in[0] + at), texel);
            least = std::min(least, roughness);
            put(out + 4 * x, roughness, roughness, roughness);
        }
        return least;
    }
    double bound_codes(double value_error, int level, double least) const override {
        double error = squared_alpha_error(value_error);
        if (bumpy(level)) error += lean_error(value_error, range_).trace;
        // The root is steepest where the surface is smoothest, and steeper yet below
        const double squared = least * least * least * least;
        const double above = roughness_of(squared + error) - least;
        const double below = least - roughness_of(std::max(0.0, squared - error));
        return 255 * std::max(above, below);
    }
    std::string words() const override {
        return range_ > 0 ? "with the spread of the normals under a texel, " + range_text(range_)
                          : "no normals: filtered as the variance it stands for";
    }

    double range_;
};

/// The third value of the first image.
class HeightTexture final : public MaterialTexture {
  public:
    explicit HeightTexture(DataPtr data) : MaterialTexture{ChannelSet::height, std::move(data)} {}

  private:
    std::span<const std::size_t> images_for(int) const noexcept override {
        static constexpr std::size_t images[] = {first_image};
        return images;
    }
    double fill_row(Rows in, int, std::int32_t width, float* out) const override {
        for (std::int32_t x = 0; x < width; ++x) {
            const float height = in[0][3 * x + 2];
            put(out + 4 * x, height, height, height);
        }
        return 0;
    }
    double bound_codes(double error, int, double) const override { return 255 * error; }
    std::string words() const override { return "linear"; }
};

/// Roots: variances of 8 bits would leave nothing of a gentle bump.
class MomentsTexture final : public MaterialTexture {
  public:
    MomentsTexture(DataPtr data, double range)
        : MaterialTexture{ChannelSet::moments, std::move(data)}, range_{range} {}

  private:
    /// One tells how level 0 is made, and stops with the budget.
    std::span<const std::size_t> images_for(int level) const noexcept override {
        static constexpr std::size_t one[] = {slopes}, all[] = {slopes, squares, products};
        if (level == 0) return one;
        return all;
    }
    double fill_row(Rows in, int level, std::int32_t width, float* out) const override {
        for (std::int32_t x = 0; x < width; ++x) {
            const std::int32_t at = 3 * x;
            const LeanTexel texel =
                level > 0 ? lean_texel(in[0] + at, in[1] + at, in[2] + at, range_) : LeanTexel{};
            const double root = std::copysign(std::sqrt(std::abs(texel.covariance)), texel.covariance);
            put(out + 4 * x, std::min(1.0, std::sqrt(texel.variance_x)),
                std::min(1.0, std::sqrt(texel.variance_y)), 0.5 + 0.5 * std::clamp(root, -1.0, 1.0));
        }
        return 0;
    }
    double bound_codes(double value_error, int level, double) const override {
        if (level == 0) return 0;
        // The root of something small is off by the root of its error
        const LeanError error = lean_error(value_error, range_);
        return 255 * std::sqrt(std::max(error.variance, error.covariance));
    }
    std::string words() const override {
        return "σx, σy and the signed root of the covariance of the normals under a texel, " +
               range_text(range_);
    }

    double range_;
};

}  // namespace

std::size_t channel_textures(const ExchangeAsset& asset) noexcept {
    const bool normal = aligned_image(asset.channels, ChannelSet::normal) != nullptr,
               roughness = aligned_image(asset.channels, ChannelSet::roughness) != nullptr,
               height = aligned_image(asset.channels, ChannelSet::height) != nullptr;
    return normal ? 3 : roughness || height ? 1 : 0;
}

std::vector<Channels> make_channels(const std::shared_ptr<const ExchangeTexture>& albedo,
                                    const ExchangeAsset& asset) {
    const auto* normal = aligned_image(asset.channels, ChannelSet::normal);
    const auto* roughness = aligned_image(asset.channels, ChannelSet::roughness);
    const auto* height = aligned_image(asset.channels, ChannelSet::height);
    const double range =
        normal != nullptr ? std::max(steepest_in(normal->exemplar), steepest_in(normal->tile)) : 0;
    std::vector<Channels> sets;
    const DataPtr data = make_channel_data(albedo, asset, range);
    if (data == nullptr) return sets;
    const auto add = [&](ChannelSet set, const std::shared_ptr<MaterialTexture>& texture) {
        if (sets.empty()) texture->count_data();
        sets.push_back({set, texture});
    };
    if (normal != nullptr) add(ChannelSet::normal, std::make_shared<NormalTexture>(data, range));
    if (roughness != nullptr) add(ChannelSet::roughness, std::make_shared<RoughnessTexture>(data, range));
    if (height != nullptr) add(ChannelSet::height, std::make_shared<HeightTexture>(data));
    if (normal != nullptr) add(ChannelSet::moments, std::make_shared<MomentsTexture>(data, range));
    return sets;
}

}  // namespace tessera
