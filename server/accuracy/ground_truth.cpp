#include "server/accuracy/ground_truth.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <optional>

#include "server/prepare/parallel.h"
#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// A footprint as the image of the unit square; the weight is the area that a small square becomes.
class Patch {
  public:
    explicit Patch(const Footprint& footprint) : c_{footprint.corners} {}
    struct Point {
        double x = 0, y = 0, weight = 0;
    };
    Point at(double u, double v) const noexcept {
        const TexelPoint along{(1 - v) * (c_[1].x - c_[0].x) + v * (c_[2].x - c_[3].x),
                               (1 - v) * (c_[1].y - c_[0].y) + v * (c_[2].y - c_[3].y)};
        const TexelPoint across{(1 - u) * (c_[3].x - c_[0].x) + u * (c_[2].x - c_[1].x),
                                (1 - u) * (c_[3].y - c_[0].y) + u * (c_[2].y - c_[1].y)};
        return {c_[0].x + u * along.x + v * (c_[3].x - c_[0].x),
                c_[0].y + u * along.y + v * (c_[3].y - c_[0].y),
                std::fabs(along.x * across.y - along.y * across.x)};
    }
    /// How much longer the first side is than the second, as a power of two.
    int stretch() const noexcept {
        const double along =
            std::hypot(c_[1].x - c_[0].x + c_[2].x - c_[3].x, c_[1].y - c_[0].y + c_[2].y - c_[3].y);
        const double across =
            std::hypot(c_[3].x - c_[0].x + c_[2].x - c_[1].x, c_[3].y - c_[0].y + c_[2].y - c_[1].y);
        if (!(along > 0)) return -64;
        if (!(across > 0)) return 64;
        return static_cast<int>(std::lround(std::log2(along / across)));
    }

  private:
    std::array<TexelPoint, 4> c_;
};

std::int64_t floor_of(double x) noexcept {
    const auto truncated = static_cast<std::int64_t>(x);
    return static_cast<double>(truncated) > x ? truncated - 1 : truncated;
}

double unit(std::uint64_t bits) noexcept { return static_cast<double>(bits & 0xffffffffu) * 0x1p-32; }

}  // namespace

Result<TrueColor> sample_truth(const Footprint& footprint, std::size_t strata, std::uint64_t key,
                               TruthTexels& texels) {
    const Patch patch{footprint};
    const int digits = std::countr_zero(strata);
    const int columns_digits = std::clamp((digits + patch.stretch()) / 2, 0, digits);
    const std::size_t columns = std::size_t{1} << columns_digits, rows = strata >> columns_digits;
    const double width = 1 / static_cast<double>(columns), height = 1 / static_cast<double>(rows);
    texels.expect(footprint, 2 * strata);

    std::array<double, 3> sum{}, squares{};
    double weights = 0;
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            std::array<std::array<float, 3>, 2> color;
            double weight = 0;
            for (auto& one : color) {
                const std::uint64_t bits = mix(key += 0x9e3779b97f4a7c15u);
                const Patch::Point p = patch.at((static_cast<double>(column) + unit(bits)) * width,
                                                (static_cast<double>(row) + unit(bits >> 32)) * height);
                const auto found = texels.at(footprint.x + floor_of(p.x), footprint.y + floor_of(p.y));
                if (!found) return found.error();
                one = *found;
                weight += p.weight / 2;
            }
            weights += weight;
            for (std::size_t c = 0; c < 3; ++c) {
                const double a = double(color[0][c]), b = double(color[1][c]);
                sum[c] += weight * (a + b) / 2;
                squares[c] += weight * weight * (a - b) * (a - b) / 4;
            }
        }
    TrueColor found;
    if (!(weights > 0)) {
        // No area: the middle
        const Patch::Point p = patch.at(0.5, 0.5);
        const auto color = texels.at(footprint.x + floor_of(p.x), footprint.y + floor_of(p.y));
        if (!color) return color.error();
        for (std::size_t c = 0; c < 3; ++c) found.color[c] = double((*color)[c]);
        return found;
    }
    for (std::size_t c = 0; c < 3; ++c) {
        found.color[c] = sum[c] / weights;
        found.variance[c] = squares[c] / (weights * weights);
    }
    return found;
}

View view_of(Situation situation) {
    View view{.situation = std::move(situation), .measured = {}, .pixels = {}, .footprints = {}};
    const std::int32_t width = view.situation.width, height = view.situation.height;
    view.measured.assign(std::size_t(width) * std::size_t(height), 0);
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x)
            if (const auto footprint = footprint_of(view.situation, x, y)) {
                const std::size_t pixel = std::size_t(y) * std::size_t(width) + std::size_t(x);
                view.measured[pixel] = 1;
                view.pixels.push_back(pixel);
                view.footprints.push_back(*footprint);
            }
    return view;
}

Result<GroundTruth> ground_truth(const View& view, const TruthSource& source, std::size_t samples,
                                 std::size_t threads, const std::stop_token& stop,
                                 const std::function<void(double)>& advance) {
    constexpr std::size_t run_pixels = 128;
    const std::size_t count = view.pixels.size();
    const std::size_t strata = std::bit_ceil(std::max(samples, least_truth_samples)) / 2;
    std::vector<TrueColor> colors(count);
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::optional<Error> failure;

    // Each thread has texels of its own, and takes run after run of neighbours
    const auto work = [&](std::size_t) {
        std::optional<InkIntegral> ink;
        std::unique_ptr<TruthTexels> texels;
        if (source.analytic)
            ink.emplace(*source.analytic);
        else
            texels = source.image ? truth_texels_of(source.image) : truth_texels_of(source.texture, stop);
        for (std::size_t begin = next.fetch_add(run_pixels); begin < count;
             begin = next.fetch_add(run_pixels)) {
            advance(static_cast<double>(begin) / static_cast<double>(count));
            for (std::size_t i = begin; i < std::min(begin + run_pixels, count); ++i) {
                if (ink) {
                    const double share = ink->share(view.footprints[i]);
                    for (std::size_t c = 0; c < 3; ++c)
                        colors[i].color[c] = double(from_srgb(source.analytic->ground[c])) * (1 - share) +
                                             double(from_srgb(source.analytic->ink[c])) * share;
                    continue;
                }
                const auto found =
                    sample_truth(view.footprints[i], strata, stream("ground truth", view.pixels[i]), *texels);
                if (!found) {
                    const std::scoped_lock lock{mutex};
                    if (!failure) failure = found.error();
                    next = count;
                    return;
                }
                colors[i] = *found;
            }
            if (stop.stop_requested()) return;
        }
    };
    for_each_index(threads, threads, work);
    if (stop.stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    if (failure) return *failure;

    GroundTruth truth;
    truth.samples = source.analytic ? 0 : 2 * strata;
    truth.codes = CodeImage(view.situation.width, view.situation.height);
    std::ranges::fill(truth.codes.codes, sky_code);
    truth.linear.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        truth.linear.push_back(colors[i].color);
        for (std::size_t c = 0; c < 3; ++c) {
            truth.codes.codes[3 * view.pixels[i] + c] =
                static_cast<float>(fractional_srgb_code(colors[i].color[c]));
            const double slope = srgb_codes_per_linear(colors[i].color[c]);
            truth.mse += colors[i].variance[c] * slope * slope;
            truth.mse_linear += colors[i].variance[c] * 255 * 255;
        }
    }
    if (count > 0) {
        truth.mse /= static_cast<double>(3 * count);
        truth.mse_linear /= static_cast<double>(3 * count);
    }
    return truth;
}

}  // namespace tessera
