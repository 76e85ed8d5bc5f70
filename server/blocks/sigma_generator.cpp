// `sigma`: the paper's permutation series (3.2), for comparison.
#include <numeric>
#include <utility>

#include "server/blocks/generators.h"
#include "server/blocks/sigma_series.h"
#include "shared/math/hash.h"

namespace tessera {

namespace {

class SigmaOp final : public CellOp {
  public:
    SigmaOp(std::uint64_t seed, const CellDraw& draw) : series_{seed, draw.key, draw.count} {}

    bool scatters() const noexcept override { return false; }
    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        for (std::int32_t i = 0; i < stretch.count; ++i)
            out[i] = series_.at(stretch.x + i, stretch.y, stretch.z);
    }
    std::size_t memory_bytes() const noexcept override { return series_.memory_bytes(); }

  private:
    SigmaSeries series_;
};

}  // namespace

SigmaSeries::SigmaSeries(std::uint64_t seed, std::uint64_t key, std::uint32_t count) : sigma_(count) {
    std::iota(sigma_.begin(), sigma_.end(), 0u);
    for (std::uint32_t i = count - 1; i > 0; --i)
        std::swap(sigma_[i], sigma_[uniform_below(hash(seed, key, i, 0), i + 1)]);
}

std::uint32_t SigmaSeries::along(std::int64_t g, std::uint32_t start) const noexcept {
    const std::uint64_t count = sigma_.size();
    auto rest = static_cast<std::uint64_t>(g);
    std::uint32_t s = start;
    for (int i = 0; i < 3; ++i) {
        s = sigma_[(rest % count + s) % count];
        rest /= count;
    }
    return s;
}

std::int32_t SigmaSeries::at(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
    return static_cast<std::int32_t>(along(x, along(y, z == 0 ? 0 : along(z, 0))));
}

std::shared_ptr<const CellOp> make_sigma_op(std::uint64_t seed, const CellDraw& draw) {
    return std::make_shared<SigmaOp>(seed, draw);
}

}  // namespace tessera
