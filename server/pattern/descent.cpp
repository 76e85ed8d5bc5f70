#include "server/pattern/descent.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr std::int32_t block_side = 32;
constexpr std::int32_t probe_side = 8;
constexpr float worthwhile = 0.8F;
constexpr float enough = static_cast<float>(0.5 * code_in_linear);
/// Rounding of a few float operations on numbers of about 1, in codes.
constexpr double rounding_codes = 1e-4;

/// And so many cells'.
constexpr std::int64_t most_exact_cells = 3584;
/// What drawn cells are summed to at most where a composite asks.
constexpr int summed_cells_log2 = 4;

/// An exact texel costs at most so many parts' texels: a page of 256² takes up to about two seconds.
constexpr std::int64_t most_exact_texels = 1536;

int deepest(Accuracy accuracy, int parts, int level) {
    if (accuracy == Accuracy::fast) return 0;
    if (accuracy == Accuracy::high) return std::min(level, 2);
    int d = 0;
    while (d < level && (std::int64_t{parts} << 2 * (d + 1)) <= most_exact_texels) ++d;
    return d;
}

/// How deep exact goes where errors are measured, and what it is then off by.
struct MeasuredDepth {
    int depth = 0;
    double codes = 0;
};
Result<MeasuredDepth> measured_depth(const MeasuredError& measured, int parts, int level, int deepest,
                                     const Budget& budget) {
    MeasuredDepth best{0, std::numeric_limits<double>::infinity()};
    for (int d = 0; d <= deepest; ++d) {
        // Cells that are summed cost, too
        const int cells_log2 = level - d - measured.cell_log2();
        const std::int64_t of_a_texel = cells_log2 > 0 && cells_log2 <= summed_cells_log2
                                            ? std::int64_t{1} << 2 * cells_log2
                                            : std::int64_t{1};
        if ((parts * of_a_texel << 2 * d) > most_exact_texels + most_exact_cells && d > 0) continue;
        const auto codes = measured.codes(level, d, budget);
        if (!codes) return codes.error();
        if (*codes < worthwhile * best.codes) best = {d, *codes};
        if (best.codes <= 0.5) break;
    }
    return best;
}

/// A square of `side` texels from (x, y) in `region` on, d levels below.
TexelRegion below(const TexelRegion& region, std::int32_t x, std::int32_t y, std::int32_t side, int d) {
    TexelRegion fine = region;
    fine.level = static_cast<std::uint8_t>(region.level - d);
    fine.x = (region.x + x) * (std::int64_t{1} << d);
    fine.y = (region.y + y) * (std::int64_t{1} << d);
    fine.width = fine.height = side << d;
    return fine;
}

/// Means of 2^d × 2^d values, `channels` of them each.
void reduce(const float* fine, std::int32_t width, std::int32_t height, int d, std::size_t channels,
            std::vector<float>& out) {
    out.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels);
    const std::size_t side = std::size_t{1} << d, pitch = static_cast<std::size_t>(width) * side * channels;
    const double share = 1.0 / static_cast<double>(side * side);
    std::vector<double> sums(static_cast<std::size_t>(width) * channels);
    for (std::int32_t y = 0; y < height; ++y) {
        std::fill(sums.begin(), sums.end(), 0.0);
        for (std::size_t row = 0; row < side; ++row, fine += pitch)
            for (std::size_t x = 0; x < static_cast<std::size_t>(width) * side; ++x)
                for (std::size_t c = 0; c < channels; ++c)
                    sums[(x >> d) * channels + c] += double{fine[x * channels + c]};
        for (std::size_t i = 0; i < sums.size(); ++i)
            out[static_cast<std::size_t>(y) * sums.size() + i] = static_cast<float>(sums[i] * share);
    }
}

/// Rows of a block between images.
template <class Value>
void copy_block(const std::vector<Value>& from, std::int32_t block_x, std::int32_t block_y,
                std::size_t channels, std::int32_t width, std::vector<Value>& to) {
    const std::size_t row = static_cast<std::size_t>(block_side) * channels;
    for (std::int32_t y = 0; y < block_side; ++y)
        std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * row), row,
                    to.begin() + static_cast<std::ptrdiff_t>((static_cast<std::size_t>(block_y + y) *
                                                                  static_cast<std::size_t>(width) +
                                                              static_cast<std::size_t>(block_x)) *
                                                             channels));
}

/// One evaluation: composed as a whole, then again, deeper, where that is not good enough.
class Descent {
  public:
    Descent(const Composite& composite, const TexelRegion& region, const Budget& budget)
        : composite_{composite},
          budget_{budget},
          hull_{region},
          least_depth_{std::max(region.level - composite.mended_from(), 1)},
          depth_{deepest(budget.accuracy, composite.parts(), region.level)} {
        if (depth_ < least_depth_ && (budget.accuracy != Accuracy::exact || composite.measured() == nullptr))
            depth_ = 0;
        if (depth_ == 0) return;
        // Whole blocks of the level's lattice
        const auto floored = [](std::int64_t at) { return at & ~std::int64_t{block_side - 1}; };
        hull_.x = floored(region.x);
        hull_.y = floored(region.y);
        hull_.width = static_cast<std::int32_t>(floored(region.x + region.width + block_side - 1) - hull_.x);
        hull_.height =
            static_cast<std::int32_t>(floored(region.y + region.height + block_side - 1) - hull_.y);
    }

    Result<void> run() {
        const auto first = composite_.compose(hull_, budget_, whole_, bounds_);
        if (!first) return first.error();
        sum_ = *first;
        doubt_ = 1 - first->confidence;
        const float of_parts = static_cast<float>(first->bound_codes * code_in_linear);
        const bool good = *std::max_element(bounds_.begin(), bounds_.end()) <= enough;
        if (const MeasuredError* measured = composite_.measured();
            measured != nullptr && budget_.accuracy == Accuracy::exact && !good && depth_ < hull_.level) {
            const auto least = measured_depth(*measured, composite_.parts(), hull_.level, depth_, budget_);
            if (!least) return least.error();
            if (std::isfinite(least->codes))
                return for_blocks(
                    [&](std::int32_t x, std::int32_t y) { return mend_as_measured(x, y, *least); });
        }
        if (depth_ < least_depth_) return {};
        return for_blocks([&](std::int32_t x, std::int32_t y) { return mend(x, y, enough + of_parts); });
    }

    /// The part that was asked for.
    Evaluation take(const TexelRegion& region, LinearImage& out) {
        float worst = 0;
        const auto dx = static_cast<std::int32_t>(region.x - hull_.x),
                   dy = static_cast<std::int32_t>(region.y - hull_.y);
        for (std::int32_t y = 0; y < region.height; ++y)
            worst = std::max(worst, worst_of(dx, y + dy, region.width, 1));
        if (hull_ == region) {
            out = std::move(whole_);
        } else {
            out = LinearImage{region.width, region.height};
            for (std::int32_t y = 0; y < region.height; ++y)
                std::copy_n(whole_.row(y + dy) + std::ptrdiff_t{dx} * 4, std::ptrdiff_t{region.width} * 4,
                            out.row(y));
        }
        sum_.bound_codes = double{worst} / code_in_linear + rounding_codes * composite_.parts();
        sum_.confidence = std::max(1 - doubt_, 0.0);
        return sum_;
    }

  private:
    template <class Mend>
    Result<void> for_blocks(const Mend& mend) {
        for (std::int32_t y = 0; y < hull_.height; y += block_side)
            for (std::int32_t x = 0; x < hull_.width; x += block_side)
                if (auto mended = mend(x, y); !mended) return mended;
        return {};
    }
    float worst_of(std::int32_t x, std::int32_t y, std::int32_t width, std::int32_t height) const {
        float worst = 0;
        for (std::int32_t row = y; row < y + height; ++row) {
            const float* bound = bounds_.data() + std::ptrdiff_t{row} * hull_.width + x;
            worst = std::max(worst, *std::max_element(bound, bound + width));
        }
        return worst;
    }
    /// Composes a block `depth` levels below; its bounds are then in block_bounds_.
    Result<Evaluation> compose_below(std::int32_t x, std::int32_t y, std::int32_t side, int depth) {
        const auto one = composite_.compose(below(hull_, x, y, side, depth), budget_, fine_, fine_bounds_);
        if (!one) return one;
        sum_.work += one->work;
        sum_.validity.meet(one->validity);
        reduce(fine_bounds_.data(), side, side, depth, 1, block_bounds_);
        return one;
    }
    void take_block(std::int32_t x, std::int32_t y, int depth) {
        reduce(fine_.values.data(), block_side, block_side, depth, 4, values_);
        copy_block(values_, x, y, 4, hull_.width, whole_.values);
        copy_block(block_bounds_, x, y, 1, hull_.width, bounds_);
    }

    Result<void> mend_as_measured(std::int32_t x, std::int32_t y, const MeasuredDepth& how) {
        if (worst_of(x, y, std::min(block_side, hull_.width), std::min(block_side, hull_.height)) <= enough)
            return {};
        if (auto spent = check_budget(budget_); !spent) return spent.error();
        if (how.depth > 0) {
            const auto one = compose_below(x, y, block_side, how.depth);
            if (!one) return one.error();
            take_block(x, y, how.depth);
        }
        const auto most = static_cast<float>(how.codes * code_in_linear);
        const std::int32_t right = std::min(x + block_side, hull_.width),
                           bottom = std::min(y + block_side, hull_.height);
        for (std::int32_t row = y; row < bottom; ++row)
            for (std::int32_t column = x; column < right; ++column) {
                float& bound = bounds_[static_cast<std::size_t>(row * hull_.width + column)];
                if (bound <= most) continue;
                bound = most;
                doubt_ = std::max(doubt_, 1 - measured_confidence);
            }
        return {};
    }

    /// As deep as the certain bound asks.
    Result<void> mend(std::int32_t x, std::int32_t y, float mended) {
        float worst = worst_of(x, y, block_side, block_side);
        if (worst <= mended) return {};
        // A corner first: where parts are about as far apart however deep one looks, there is no use
        if (const float corner = worst_of(x, y, probe_side, probe_side); corner > mended) {
            if (const auto probe = compose_below(x, y, probe_side, depth_); !probe) return probe.error();
            if (*std::max_element(block_bounds_.begin(), block_bounds_.end()) > worthwhile * corner)
                return {};
        }
        for (int d = least_depth_; d <= depth_ && worst > mended; ++d) {
            if (auto spent = check_budget(budget_); !spent) return spent.error();
            const auto one = compose_below(x, y, block_side, d);
            if (!one) return one.error();
            const float reached = *std::max_element(block_bounds_.begin(), block_bounds_.end());
            if (reached >= worst) continue;
            worst = reached;
            doubt_ = std::max(doubt_, (1 - one->confidence) * static_cast<double>(std::int64_t{1} << 2 * d));
            take_block(x, y, d);
        }
        return {};
    }

    const Composite& composite_;
    const Budget& budget_;
    TexelRegion hull_;
    int least_depth_, depth_;
    LinearImage whole_, fine_;
    std::vector<float> bounds_, fine_bounds_, values_, block_bounds_;
    Evaluation sum_;
    double doubt_ = 0;
};

}  // namespace

Result<Evaluation> CompositePart::evaluate(const TexelRegion& region, const Budget& budget, LinearImage& out,
                                           std::vector<float>& bounds) const {
    if (composite_ != nullptr) return composite_->compose(region, budget, out, bounds);
    const auto one = cells_ != nullptr ? cells_->evaluate_part(region, budget, out)
                                       : texture_->evaluate(region, budget, out);
    if (one) bounds.assign(out.values.size() / 4, static_cast<float>(one->bound_codes * code_in_linear));
    return one;
}

Result<Evaluation> evaluate_descending(const Composite& composite, const TexelRegion& region,
                                       const Budget& budget, LinearImage& out) {
    Descent descent{composite, region, budget};
    if (auto run = descent.run(); !run) return run.error();
    return descent.take(region, out);
}

}  // namespace tessera
