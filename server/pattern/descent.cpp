#include "server/pattern/descent.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::int32_t block_side = 32;
constexpr std::int32_t probe_side = 8;
constexpr float worthwhile = 0.8F;
constexpr float enough = static_cast<float>(0.5 * code_in_linear);
/// Rounding of a few float operations on numbers of about 1, in codes.
constexpr double rounding_codes = 1e-4;

/// An exact texel costs at most so many parts' texels: a page of 256² takes up to about two seconds.
constexpr std::int64_t most_exact_texels = 1536;

int deepest(Accuracy accuracy, int parts, int level) {
    if (accuracy == Accuracy::fast) return 0;
    if (accuracy == Accuracy::high) return std::min(level, 2);
    int d = 0;
    while (d < level && (std::int64_t{parts} << 2 * (d + 1)) <= most_exact_texels) ++d;
    return d;
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
    // Whole blocks of the level's lattice
    const auto floored = [](std::int64_t at) { return at & ~std::int64_t{block_side - 1}; };
    TexelRegion hull = region;
    hull.x = floored(region.x);
    hull.y = floored(region.y);
    hull.width = static_cast<std::int32_t>(floored(region.x + region.width + block_side - 1) - hull.x);
    hull.height = static_cast<std::int32_t>(floored(region.y + region.height + block_side - 1) - hull.y);
    const int least_depth = std::max(region.level - composite.mended_from(), 1);
    int depth = deepest(budget.accuracy, composite.parts(), region.level);
    if (depth < least_depth) depth = 0;
    if (depth == 0) hull = region;

    LinearImage whole;
    std::vector<float> bounds;
    Result<Evaluation> first = composite.compose(hull, budget, whole, bounds);
    if (!first) return first;
    Evaluation sum = *first;
    double doubt = 1 - first->confidence;
    const float mended = enough + static_cast<float>(first->bound_codes * code_in_linear);

    if (depth > 0) {
        LinearImage fine;
        std::vector<float> fine_bounds, values, block_bounds;
        for (std::int32_t by = 0; by < hull.height; by += block_side)
            for (std::int32_t bx = 0; bx < hull.width; bx += block_side) {
                float worst = 0;
                for (std::int32_t y = by; y < by + block_side; ++y) {
                    const float* row = bounds.data() + std::ptrdiff_t{y} * hull.width + bx;
                    worst = std::max(worst, *std::max_element(row, row + block_side));
                }
                if (worst <= mended) continue;
                // A corner first: where parts are about as far apart however deep one looks, there is no use
                float corner = 0;
                for (std::int32_t y = by; y < by + probe_side; ++y) {
                    const float* row = bounds.data() + std::ptrdiff_t{y} * hull.width + bx;
                    corner = std::max(corner, *std::max_element(row, row + probe_side));
                }
                if (corner > mended) {
                    const auto probe =
                        composite.compose(below(hull, bx, by, probe_side, depth), budget, fine, fine_bounds);
                    if (!probe) return probe;
                    sum.work += probe->work;
                    sum.validity.meet(probe->validity);
                    reduce(fine_bounds.data(), probe_side, probe_side, depth, 1, block_bounds);
                    if (*std::max_element(block_bounds.begin(), block_bounds.end()) > worthwhile * corner)
                        continue;
                }
                for (int d = least_depth; d <= depth && worst > mended; ++d) {
                    if (auto spent = check_budget(budget); !spent) return spent.error();
                    const auto one =
                        composite.compose(below(hull, bx, by, block_side, d), budget, fine, fine_bounds);
                    if (!one) return one;
                    sum.work += one->work;
                    sum.validity.meet(one->validity);
                    reduce(fine_bounds.data(), block_side, block_side, d, 1, block_bounds);
                    const float reached = *std::max_element(block_bounds.begin(), block_bounds.end());
                    if (reached >= worst) continue;
                    worst = reached;
                    doubt = std::max(doubt,
                                     (1 - one->confidence) * static_cast<double>(std::int64_t{1} << 2 * d));
                    reduce(fine.values.data(), block_side, block_side, d, 4, values);
                    copy_block(values, bx, by, 4, hull.width, whole.values);
                    copy_block(block_bounds, bx, by, 1, hull.width, bounds);
                }
            }
    }

    // The part that was asked for
    float worst = 0;
    const auto dx = static_cast<std::int32_t>(region.x - hull.x),
               dy = static_cast<std::int32_t>(region.y - hull.y);
    for (std::int32_t y = 0; y < region.height; ++y) {
        const float* row = bounds.data() + std::ptrdiff_t{y + dy} * hull.width + dx;
        worst = std::max(worst, *std::max_element(row, row + region.width));
    }
    if (hull == region) {
        out = std::move(whole);
    } else {
        out = LinearImage{region.width, region.height};
        for (std::int32_t y = 0; y < region.height; ++y)
            std::copy_n(whole.row(y + dy) + std::ptrdiff_t{dx} * 4, std::ptrdiff_t{region.width} * 4,
                        out.row(y));
    }
    sum.bound_codes = double{worst} / code_in_linear + rounding_codes * composite.parts();
    sum.confidence = std::max(1 - doubt, 0.0);
    return sum;
}

}  // namespace tessera
