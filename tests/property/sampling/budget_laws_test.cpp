// What a budget promises of a sample, held against sums over texels of level 0 cut by the footprint.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "server/pattern/cell_texture.h"
#include "server/sampling/sample_plan.h"
#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"
#include "shared/math/hash.h"
#include "tests/support/made_areas.h"
#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

using Polygon = std::vector<TexelPoint>;

/// The part of a convex polygon where sign·(coordinate − at) >= 0.
Polygon cut(const Polygon& polygon, bool by_y, double at, double sign) {
    Polygon out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const TexelPoint a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double da = sign * ((by_y ? a.y : a.x) - at), db = sign * ((by_y ? b.y : b.x) - at);
        if (da >= 0) out.push_back(a);
        if ((da < 0) != (db < 0)) {
            const double t = da / (da - db);
            out.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
        }
    }
    return out;
}

double area_of(const Polygon& polygon) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const TexelPoint o = polygon[0], a = polygon[i], b = polygon[i + 1];
        twice += (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    }
    return std::fabs(twice) / 2;
}

/// The average over the footprint, texel by texel.
std::array<double, 4> truth(const Texture& texture, const Footprint& footprint) {
    Polygon polygon(footprint.corners.begin(), footprint.corners.end());
    double left = polygon[0].x, right = left, top = polygon[0].y, bottom = top;
    for (const TexelPoint p : polygon) {
        left = std::min(left, p.x);
        right = std::max(right, p.x);
        top = std::min(top, p.y);
        bottom = std::max(bottom, p.y);
    }
    const auto x0 = static_cast<std::int64_t>(std::floor(left)),
               y0 = static_cast<std::int64_t>(std::floor(top));
    const auto width = static_cast<std::int32_t>(static_cast<std::int64_t>(std::floor(right)) - x0 + 1);
    const auto height = static_cast<std::int32_t>(static_cast<std::int64_t>(std::floor(bottom)) - y0 + 1);
    std::array<double, 4> sum{};
    double all = 0;
    LinearImage texels;
    for (std::int32_t from = 0; from < height; from += 512) {
        const std::int32_t rows = std::min(512, height - from);
        EXPECT_TRUE(
            texture.evaluate({0, footprint.x + x0, footprint.y + y0 + from, width, rows, footprint.slice},
                             {.accuracy = Accuracy::exact}, texels));
        for (std::int32_t y = 0; y < rows; ++y) {
            const auto at = static_cast<double>(y0 + from + y);
            const Polygon row = cut(cut(polygon, true, at, 1), true, at + 1, -1);
            if (row.size() < 3) continue;
            double row_left = row[0].x, row_right = row_left;
            for (const TexelPoint p : row) {
                row_left = std::min(row_left, p.x);
                row_right = std::max(row_right, p.x);
            }
            // Between the edges at the top and at the bottom of the row every texel is whole, where both are
            // met
            double inner_left = 1e300, inner_right = -1e300;
            double tops[2] = {1e300, -1e300}, bottoms[2] = {1e300, -1e300};
            for (const TexelPoint p : row) {
                double* const ends = p.y == at ? tops : p.y == at + 1 ? bottoms : nullptr;
                if (ends == nullptr) continue;
                ends[0] = std::min(ends[0], p.x);
                ends[1] = std::max(ends[1], p.x);
            }
            if (tops[0] < tops[1] && bottoms[0] < bottoms[1]) {
                inner_left = std::max(tops[0], bottoms[0]);
                inner_right = std::min(tops[1], bottoms[1]);
            }
            const auto first = static_cast<std::int64_t>(std::floor(row_left)) - x0;
            const auto last =
                std::min<std::int64_t>(static_cast<std::int64_t>(std::floor(row_right)) - x0, width - 1);
            for (std::int64_t x = first; x <= last; ++x) {
                const auto column = static_cast<double>(x0 + x);
                const bool inside = column >= inner_left && column + 1 <= inner_right;
                const double part =
                    inside ? 1 : area_of(cut(cut(row, false, column, 1), false, column + 1, -1));
                all += part;
                for (std::size_t c = 0; c < 4; ++c)
                    sum[c] += part * static_cast<double>(texels.row(y)[4 * x + static_cast<std::int64_t>(c)]);
            }
        }
    }
    for (double& channel : sum) channel /= all;
    return sum;
}

double uniform(std::int64_t i, std::int64_t n) {
    return static_cast<double>(hash(3, stream("footprint"), i, n) >> 11) * 0x1p-53;
}

/// Convex quadrilaterals of up to so many texels a side, wherever they lie.
std::vector<Footprint> footprints(int count, double smallest, double largest, std::int64_t seed) {
    std::vector<Footprint> all;
    for (std::int64_t i = seed; std::ssize(all) < count; ++i) {
        const double side = smallest * std::pow(largest / smallest, uniform(i, 0));
        const double ratio = std::pow(30, uniform(i, 1)), turn = 7 * uniform(i, 2);
        const double along = std::min(side * std::sqrt(ratio), largest), across = side / std::sqrt(ratio);
        const std::int64_t far = i % 5 == 0 ? std::int64_t{1} << 38 : 0;
        Footprint footprint =
            footprint_around(far + static_cast<std::int64_t>(uniform(i, 3) * 2000) - 1000,
                             static_cast<std::int64_t>(uniform(i, 4) * 2000) - far,
                             {uniform(i, 5), uniform(i, 6)}, {along * std::cos(turn), along * std::sin(turn)},
                             {-across * std::sin(turn), across * std::cos(turn)});
        // One corner moves inwards, as in perspective
        const TexelPoint middle = axes_of(footprint).centre;
        TexelPoint& corner = footprint.corners[static_cast<std::size_t>(i % 4)];
        const double inwards = 0.4 * uniform(i, 7);
        corner = {corner.x + inwards * (middle.x - corner.x), corner.y + inwards * (middle.y - corner.y)};
        all.push_back(footprint);
    }
    return all;
}

/// Pages and samplers of one texture.
class Sampled {
  public:
    explicit Sampled(std::shared_ptr<const Texture> texture) : texture_{std::move(texture)} {}

    std::vector<FilteredSample> sample(const SamplePlan& plan, std::span<const Footprint> of,
                                       std::vector<std::uint8_t>& steps) {
        std::vector<FilteredSample> samples(of.size());
        steps.assign(of.size(), 0);
        const auto run = [&](const SampleStep& step, std::span<const Footprint> some,
                             std::span<FilteredSample> out) -> Result<void> {
            auto& pages = pages_[step.texels];
            if (!pages) pages = pages_of_texture(texture_, step.texels, std::size_t{64} << 20);
            auto& sampler = samplers_[{name_of(step.filter), step.texels}];
            if (!sampler) sampler = make_sampler(step.filter, pages);
            return sampler->sample(some, {.accuracy = step.texels}, out);
        };
        EXPECT_TRUE(sample_by(plan, of, run, samples, steps));
        return samples;
    }

  private:
    std::shared_ptr<const Texture> texture_;
    std::map<Accuracy, std::shared_ptr<const TexelPages>> pages_;
    std::map<std::pair<std::string, Accuracy>, std::unique_ptr<FootprintSampler>> samplers_;
};

struct Budgeted {
    std::string name;
    SamplePlan plan;
};

std::vector<Budgeted> budgets() {
    std::vector<Budgeted> all;
    for (const Accuracy accuracy : accuracies)
        all.push_back({std::string{name_of(accuracy)}, choose_filter({}, accuracy, {})});
    for (const double codes : {30.0, 4.0, 1.0, 0.25, 0.02, 0.0})
        all.push_back({"max_error " + std::to_string(codes), choose_filter({}, Accuracy::high, codes)});
    return all;
}

/// How often a budget was answered by each of its steps.
using StepCounts = std::map<std::string, std::vector<int>>;

/// Bounds that are certain hold always. Those of a confidence hold here too: that one of a few thousand fails
/// that may fail once in 10^9 would be a wrong bound.
StepCounts expect_bounds_to_hold(const std::string& name, const std::shared_ptr<const Texture>& texture,
                                 const std::vector<Footprint>& of) {
    std::vector<std::array<double, 4>> truths;
    for (const Footprint& footprint : of) truths.push_back(truth(*texture, footprint));
    Sampled sampled{texture};
    StepCounts counts;
    for (const auto& [budget, plan] : budgets()) {
        std::vector<std::uint8_t> steps;
        const auto samples = sampled.sample(plan, of, steps);
        counts[budget].resize(plan.steps.size());
        for (std::size_t i = 0; i < of.size(); ++i) {
            ++counts[budget][steps[i]];
            double error = 0;
            for (std::size_t c = 0; c < 4; ++c)
                error =
                    std::max(error, std::fabs(static_cast<double>(samples[i].color[c]) - truths[i][c]) * 255);
            EXPECT_LE(error, samples[i].bound_codes + 1e-5) << name << ", " << budget << ", footprint " << i
                                                            << ", " << name_of(plan.steps[steps[i]].filter);
            EXPECT_GE(samples[i].confidence, 1 - 1e-6) << name << ", " << budget;
            // An answer beyond the limit is the best there is
            if (samples[i].bound_codes > plan.enough_codes && plan.steps.size() > 1) {
                EXPECT_LE(samples[i].bound_codes, 255);
                const SamplePlan best{{plan.steps.back()}, 0};
                std::vector<std::uint8_t> ignored;
                const auto least = sampled.sample(best, {&of[i], 1}, ignored);
                EXPECT_LE(samples[i].bound_codes, least[0].bound_codes)
                    << name << ", " << budget << ", footprint " << i;
            }
        }
    }
    return counts;
}

TEST(BudgetLaws, HoldOverAChecker) {
    const auto texture = make_checker_texture(13, {250, 30, 90, 255}, {10, 200, 40, 130});
    auto of = footprints(40, 0.2, 100, 0);
    for (const Footprint& large : footprints(1, 1200, 1300, 5001)) of.push_back(large);
    const StepCounts counts = expect_bounds_to_hold("checker", texture, of);
    for (const auto& [budget, steps] : counts) {
        if (budget.starts_with("max_error 0.25")) {
            EXPECT_EQ(steps[0], 40);  // the large one alone needed more than a line integral
            EXPECT_EQ(steps[1], 1);
        }
        if (budget == "fast") {
            EXPECT_GT(steps[0], 35);
        }
    }
}

TEST(BudgetLaws, HoldOverAnImage) {
    // Noise under any window of it, as a photograph that repeats
    tests::SyntheticAssetOptions options;
    options.tile_side = 64;
    options.contents = 1;
    const auto texture = make_exchange_texture(tests::make_synthetic_wang(options), {});
    expect_bounds_to_hold("wang tiles of noise", texture, footprints(40, 0.2, 120, 100));
}

TEST(BudgetLaws, HoldOverContentExchange) {
    tests::SyntheticAssetOptions options;
    options.tile_side = 32;
    for (const Choice choice : {Choice::typed, Choice::independent}) {
        ExchangeOptions exchange;
        exchange.choice = choice;
        const auto texture = make_exchange_texture(tests::make_synthetic_asset(options), exchange);
        expect_bounds_to_hold(
            choice == Choice::typed ? "typed" : "independent", texture,
            choice == Choice::typed ? footprints(30, 0.5, 150, 200) : footprints(12, 0.5, 100, 200));
    }
}

TEST(BudgetLaws, HoldOverPatternsWhoseProbabilitiesVary) {
    // One texel a cell, drawn from dithered areas: above level 0 fast and high give expectations
    MadeAreas areas{.map = made_map(13, 9, 16, StoredMap::Edge::wrap, 5, 3, -4),
                    .sampling = VaryingMap::Sampling::dithered,
                    .choice_of = [](auto states) {
                        return std::vector<std::int32_t>{states[0], (states[0] * 7 + 1) % 16};
                    }};
    const auto texture = make_cell_texture(made_area_plan(areas, made_patterns(1, 16)));
    auto of = footprints(20, 0.5, 90, 300);
    for (const Footprint& large : footprints(2, 200, 300, 6000)) of.push_back(large);
    expect_bounds_to_hold("dithered areas", texture, of);

    // Coarser texels carry their expectation's bound into the sample: a strict limit needs exact ones
    constexpr FootprintFilter exact{.kind = FilterKind::exact};
    const Footprint square = footprint_around(100, 100, {0, 0}, {300, 10}, {-10, 300});
    Sampled sampled{texture};
    std::vector<std::uint8_t> steps;
    const SamplePlan on_fast{{{exact, Accuracy::fast}}, 0}, on_exact{{{exact, Accuracy::exact}}, 0};
    const double loose = sampled.sample(on_fast, {&square, 1}, steps)[0].bound_codes;
    const double strict = sampled.sample(on_exact, {&square, 1}, steps)[0].bound_codes;
    ASSERT_LT(strict, loose);
    for (const double limit : {loose, (loose + strict) / 2}) {
        const SamplePlan both{{{exact, Accuracy::fast}, {exact, Accuracy::exact}}, limit};
        EXPECT_LE(sampled.sample(both, {&square, 1}, steps)[0].bound_codes, limit);
        EXPECT_EQ(steps[0], limit < loose ? 1 : 0);
    }
}

}  // namespace
}  // namespace tessera
