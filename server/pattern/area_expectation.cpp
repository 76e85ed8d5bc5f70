#include "server/pattern/area_expectation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "server/pattern/look_mixture.h"
#include "server/pattern/map_expectation.h"

namespace tessera {
namespace {

constexpr double rounding_codes = 4e-5;

/// The same probabilities everywhere: one colour.
class StationaryExpectation final : public AreaExpectation {
  public:
    StationaryExpectation(const CellProgram& program, const LookMeans& means, std::int32_t slice,
                          double uneven)
        : independent_{program.independent_cells()}, uneven_{uneven} {
        const std::vector<LookShare> shares = program.shares({});
        base_ = base_of(shares, means, slice);
        mixture_ = mixture_of(shares, means, slice, base_);
        const std::vector<std::int32_t> rising = program.nested_patterns();
        for (std::size_t i = 1; i < rising.size(); ++i) {
            const Colour from = means.of(rising[i - 1], 0, 0, slice), to = means.of(rising[i], 0, 0, slice);
            for (std::size_t c = 0; c < 4; ++c) variation_[c] += std::abs(to[c] - from[c]);
        }
        is_nested_ = !rising.empty();
    }

    Result<Evaluation> evaluate(const TexelRegion& region, int up, const Budget& budget, LinearImage& out,
                                std::int64_t) const override {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        std::array<float, 4> colour;
        for (std::size_t c = 0; c < 4; ++c) colour[c] = static_cast<float>(base_[c] + mixture_.mean[c]);
        for (std::size_t i = 0; i < out.values.size(); i += 4)
            std::copy(colour.begin(), colour.end(), out.values.begin() + static_cast<std::ptrdiff_t>(i));
        const ChanceBound of_level = bound(up);
        return Evaluation{.method = "expectation",
                          .bound_codes = of_level.codes + rounding_codes,
                          .confidence = of_level.confidence,
                          .work = std::uint64_t(region.height)};
    }

    bool uniform() const noexcept override { return true; }

    ChanceBound bound(int up) const noexcept override {
        const double side = static_cast<double>(std::int64_t{1} << up), cells = side * side;
        const double range = mixture_.range.width();
        ChanceBound least{255 * range, 1};  // both lie among the colours that cells may show
        if (range <= 0) return {};
        if (is_nested_) {
            // The number of cells below each threshold is right within one in every aligned block: Abel's sum
            const double codes = 255 * *std::max_element(variation_.begin(), variation_.end()) / cells;
            least.codes = std::min(least.codes, codes);
        } else if (independent_) {
            double codes = 0;
            for (std::size_t c = 0; c < 4; ++c) codes = std::max(codes, channel_codes(c, cells));
            if (codes < least.codes) least = {codes, stated_confidence};
        }
        return least;
    }
    std::size_t memory_bytes() const noexcept override { return sizeof *this; }

  private:
    /// Hoeffding's bound, or Bernstein's where a channel seldom strays far: the variance is known.
    double channel_codes(std::size_t c, double cells) const noexcept {
        const double width = mixture_.range.most[c] - mixture_.range.least[c];
        const double hoeffding = chance_codes(width, cells);
        const double farthest =
            std::max(mixture_.range.most[c] - mixture_.mean[c], mixture_.mean[c] - mixture_.range.least[c]);
        // Shares that lie elsewhere shift the mean by so much of the width, and squares and the mean's square
        const double linear = 2 * (farthest + uneven_ * width) * log_of_odds / 3;
        const double variance = mixture_.variance[c] + 3 * uneven_ * width * width;
        const double bernstein =
            (linear + std::sqrt(linear * linear + 8 * cells * log_of_odds * variance)) / (2 * cells);
        return std::min(hoeffding, 255 * bernstein);
    }

    bool independent_;
    double uneven_;
    bool is_nested_ = false;
    Colour base_{};
    LookMixture mixture_;
    Colour variation_{};
};

}  // namespace

std::unique_ptr<const AreaExpectation> make_area_expectation(const CellProgram& program,
                                                             const LookMeans& means, std::int32_t slice,
                                                             double uneven) {
    switch (program.basis()) {
        case CellProgram::Basis::constant:
        case CellProgram::Basis::stationary:
            return std::make_unique<const StationaryExpectation>(program, means, slice, uneven);
        case CellProgram::Basis::varying:
            return make_map_expectation(program, means, slice, uneven);
        case CellProgram::Basis::typed:
        case CellProgram::Basis::other:
            break;
    }
    return nullptr;
}

std::uint64_t area_expectation_bytes(const CellProgram& program) {
    if (program.basis() != CellProgram::Basis::varying) return 0;
    const auto varying = program.varying();
    return varying ? map_expectation_bytes(*varying->map) : 0;
}

}  // namespace tessera
