#include "server/texture/constant_texture.h"

#include <algorithm>
#include <vector>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

class ConstantTexture final : public Texture {
  public:
    explicit ConstantTexture(Rgba8 color) : color_{to_linear(color)} {}

    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget&, LinearImage& out) const override {
        out = LinearImage{region.width, region.height};
        for (std::size_t i = 0; i < out.values.size(); i += 4)
            std::copy_n(color_.begin(), 4, out.values.begin() + std::ptrdiff_t(i));
        return Evaluation{.method = "constant", .work = 1};
    }
    std::string_view kind() const noexcept override { return "constant"; }
    std::string description() const override { return "constant colour, once per scene"; }
    std::size_t memory_bytes() const noexcept override { return sizeof *this; }

  private:
    std::array<float, 4> color_;
};

class CheckerTexture final : public Texture {
  public:
    CheckerTexture(std::int64_t cell, Rgba8 first, Rgba8 second)
        : cell_{cell}, first_{to_linear(first)}, second_{to_linear(second)} {}

    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        out = LinearImage{region.width, region.height};
        // The board is s(x)·s(y) with s = ±1, so that its mean over a texel is the product of two means
        const std::vector<float> columns = wave_means(region.x, region.width, region.level);
        const std::vector<float> rows = wave_means(region.y, region.height, region.level);
        for (std::int32_t y = 0; y < region.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            float* texel = out.row(y);
            for (std::int32_t x = 0; x < region.width; ++x, texel += 4) {
                const float share = 0.5F + 0.5F * columns[std::size_t(x)] * rows[std::size_t(y)];
                for (std::size_t c = 0; c < 4; ++c) texel[c] = second_[c] + share * (first_[c] - second_[c]);
            }
        }
        return Evaluation{.method = "closed form",
                          .work = std::uint64_t(region.width) + std::uint64_t(region.height)};
    }
    std::string_view kind() const noexcept override { return "checker"; }
    std::string description() const override {
        return "checker of " + std::to_string(cell_) + " texels, box-filtered in closed form, once per texel";
    }
    std::size_t memory_bytes() const noexcept override { return sizeof *this; }

  private:
    /// The integral of the square wave from 0 to x: up and down again, period 2·cell.
    std::int64_t integral(std::int64_t x) const {
        const std::int64_t period = 2 * cell_;
        const std::int64_t phase = ((x % period) + period) % period;
        return phase < cell_ ? phase : period - phase;
    }

    /// Means of the wave over `count` texels of `level` from `start` on.
    std::vector<float> wave_means(std::int64_t start, std::int32_t count, std::uint8_t level) const {
        std::vector<float> means(static_cast<std::size_t>(count));
        // Reduced modulo the period (at most 2^21) first, so that no coordinate is too far out to multiply
        const std::int64_t period = 2 * cell_;
        const std::int64_t side = std::int64_t{1} << level;
        for (std::int32_t i = 0; i < count; ++i) {
            const std::int64_t from = (start + i) % period * (side % period) % period;
            means[std::size_t(i)] = static_cast<float>(integral(from + side % period) - integral(from)) /
                                    static_cast<float>(side);
        }
        return means;
    }

    std::int64_t cell_;
    std::array<float, 4> first_, second_;
};

}  // namespace

std::array<float, 4> to_linear(Rgba8 color) noexcept {
    const float alpha = static_cast<float>(color.alpha) / 255.0F;
    return {from_srgb(color.red) * alpha, from_srgb(color.green) * alpha, from_srgb(color.blue) * alpha,
            alpha};
}

std::shared_ptr<const Texture> make_constant_texture(Rgba8 color) {
    return std::make_shared<ConstantTexture>(color);
}

std::shared_ptr<const Texture> make_checker_texture(std::int64_t cell_texels, Rgba8 first, Rgba8 second) {
    return std::make_shared<CheckerTexture>(cell_texels, first, second);
}

}  // namespace tessera
