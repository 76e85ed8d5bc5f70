#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "server/pattern/texel_range.h"

namespace tessera {

/// Means over a texel as far as they are known: an estimate, and limits that certainly hold. Four channels.
struct KnownMeans {
    std::array<float, 4> estimate{};
    std::array<float, 4> least{};
    std::array<float, 4> most{};

    /// The farthest that any channel's mean can be from its estimate.
    float bound() const noexcept {
        float bound = 0;
        for (std::size_t c = 0; c < 4; ++c)
            bound = std::max({bound, most[c] - estimate[c], estimate[c] - least[c]});
        return bound;
    }
};

/// The mean of a product where only the factors' means are known. For variables X in [0, 1] with mean x, and
/// Y in [0, 1] with mean y, max(0, x + y − 1) ≤ E[XY] ≤ min(x, y): XY ≤ X and XY ≤ Y, and
/// (1 − X)(1 − Y) ≥ 0 (Fréchet's limits). A share w in [w0, w1] times a colour v in [v0, v1] is that, moved
/// and stretched:
///     w·v = w0·v0 + w0·(v1 − v0)·Y + v0·(w1 − w0)·X + (w1 − w0)·(v1 − v0)·XY.
/// All coefficients are positive, and both limits grow with x and y: limits of the means give limits of the
/// product. One factor constant: the product is exact.
class ProductLimits {
  public:
    ProductLimits(float share_least, float share_most, float value_least, float value_most) noexcept
        : share_0_{share_least},
          share_range_{share_most - share_least},
          value_0_{value_least},
          value_range_{value_most - value_least},
          per_share_{share_range_ > 0 ? 1 / share_range_ : 0},
          per_value_{value_range_ > 0 ? 1 / value_range_ : 0} {}
    ProductLimits() = default;

    float least(float share, float value) const noexcept {
        const float x = unit((share - share_0_) * per_share_), y = unit((value - value_0_) * per_value_);
        return moved(x, y) + share_range_ * value_range_ * std::max(0.0F, x + y - 1);
    }
    float most(float share, float value) const noexcept {
        const float x = unit((share - share_0_) * per_share_), y = unit((value - value_0_) * per_value_);
        return moved(x, y) + share_range_ * value_range_ * std::min(x, y);
    }

  private:
    static float unit(float x) noexcept { return std::min(std::max(x, 0.0F), 1.0F); }
    float moved(float x, float y) const noexcept {
        return share_0_ * (value_0_ + value_range_ * y) + value_0_ * share_range_ * x;
    }

    float share_0_ = 0, share_range_ = 1, value_0_ = 0, value_range_ = 1, per_share_ = 1, per_value_ = 1;
};

/// Composites a layer's means over those of what is below: upper + (1 − its alpha)·lower, whose last term is
/// a product of two means. Written for four channels at a time.
class MeansOver {
  public:
    /// `one_texel`: of level 0, where a texel is one value and products are exact.
    MeansOver(const TexelRange& upper, const TexelRange& lower, bool one_texel) noexcept
        : upper_{upper}, result_{range_over(upper, lower)}, one_texel_{one_texel} {
        share_0_ = 1 - upper.most[3];
        share_range_ = upper.most[3] - upper.least[3];
        per_share_ = share_range_ > 0 ? 1 / share_range_ : 0;
        for (std::size_t c = 0; c < 4; ++c) {
            value_0_[c] = lower.least[c];
            value_range_[c] = lower.most[c] - lower.least[c];
            per_value_[c] = value_range_[c] > 0 ? 1 / value_range_[c] : 0;
            both_[c] = share_range_ * value_range_[c];
        }
    }

    /// `upper`: four channels, each within `error` of the mean.
    void operator()(const float* upper, float error, KnownMeans& below) const noexcept {
        const float share = 1 - upper[3];
        const float share_least = std::max(share - error, 1 - upper_.most[3]);
        const float share_most = std::min(share + error, 1 - upper_.least[3]);
        const float x_least = unit((share_least - share_0_) * per_share_);
        const float x_most = unit((share_most - share_0_) * per_share_);
        std::array<float, 4> least, most;
        for (std::size_t c = 0; c < 4; ++c) {
            // ProductLimits, of each channel
            const float y_least = unit((below.least[c] - value_0_[c]) * per_value_[c]);
            const float y_most = unit((below.most[c] - value_0_[c]) * per_value_[c]);
            least[c] = share_0_ * (value_0_[c] + value_range_[c] * y_least) +
                       value_0_[c] * share_range_ * x_least +
                       both_[c] * std::max(0.0F, x_least + y_least - 1);
            most[c] = share_0_ * (value_0_[c] + value_range_[c] * y_most) +
                      value_0_[c] * share_range_ * x_most + both_[c] * std::min(x_most, y_most);
        }
        if (one_texel_)
            for (std::size_t c = 0; c < 4; ++c) {
                least[c] = share_least * below.least[c];
                most[c] = share_most * below.most[c];
            }
        for (std::size_t c = 0; c < 4; ++c) {
            below.least[c] =
                std::max(std::max(upper[c] - error, upper_.least[c]) + least[c], result_.least[c]);
            below.most[c] = std::min(std::min(upper[c] + error, upper_.most[c]) + most[c], result_.most[c]);
            below.estimate[c] = upper[c] + share * below.estimate[c];
        }
        // Premultiplied: no channel is more than alpha
        for (std::size_t c = 0; c < 3; ++c) below.most[c] = std::min(below.most[c], below.most[3]);
    }

    const TexelRange& range() const noexcept { return result_; }

  private:
    static float unit(float x) noexcept { return std::min(std::max(x, 0.0F), 1.0F); }

    TexelRange upper_, result_;
    float share_0_, share_range_, per_share_;
    std::array<float, 4> value_0_, value_range_, per_value_, both_;
    bool one_texel_;
};

}  // namespace tessera
