#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/texture/exchange.h"

namespace tessera {

/// A place in the photograph that a patch might show.
struct Candidate {
    std::uint64_t cost = 0;  ///< The less, the better it fits.
    ExchangeAsset::Offset at;

    bool operator<(const Candidate& other) const {
        return std::tuple{cost, at.y, at.x} < std::tuple{other.cost, other.at.y, other.at.x};
    }
};

/// Chebyshev's distance of two places is at least `distance`.
bool lie_apart(const ExchangeAsset::Offset& a, const ExchangeAsset::Offset& b, std::int32_t distance);

/// The cheapest of the sorted candidates that lie `distance` apart from each other and from `taken`; at most
/// `count`.
std::vector<Candidate> spread(const std::vector<Candidate>& sorted,
                              const std::vector<ExchangeAsset::Offset>& taken, std::int32_t distance,
                              std::size_t count);

/// How much goes on in each box of the photograph, against the whole. What is flat fits anywhere tolerably,
/// so that borders alone would fill the texture with the photograph's dullest parts.
class Liveliness {
  public:
    explicit Liveliness(const PerceptualImage& photo);

    /// `cost` raised up to twofold for a flat box, lowered for a lively one, unchanged for an average one.
    /// The box is inside the photograph.
    std::uint64_t weigh(std::uint64_t cost, const ExchangeAsset::Offset& at, std::int32_t width,
                        std::int32_t height) const;

  private:
    std::uint64_t sum_to(std::int32_t x, std::int32_t y) const;

    std::int32_t width_ = 0;
    std::vector<std::uint64_t> sums_;  ///< Of squared gradients, over all texels above and left.
    std::uint64_t mean_ = 0;
};

/// How often each part of the photograph is shown.
class PhotoUses {
  public:
    explicit PhotoUses(const PerceptualImage& photo);

    /// The mean over a box, in 256ths of the mean over the photograph.
    std::uint64_t relative(const ExchangeAsset::Offset& at, std::int32_t width, std::int32_t height) const;
    void add(const ExchangeAsset::Offset& at, std::int32_t width, std::int32_t height);

  private:
    static constexpr std::int32_t cell = 8;
    std::size_t index(std::int32_t x, std::int32_t y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    std::int32_t width_, height_;
    std::vector<std::uint32_t> counts_;
    std::uint64_t total_ = 0;
};

}  // namespace tessera
