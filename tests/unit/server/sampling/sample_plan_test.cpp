#include "server/sampling/sample_plan.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr FootprintFilter line{.kind = FilterKind::line_integral}, exact{.kind = FilterKind::exact},
    probes{.kind = FilterKind::anisotropic, .probes = 4};

FilteredSample sample(double bound, double confidence, float color, std::uint64_t texels = 5) {
    return {{color, color, color, 1}, bound, confidence, texels};
}

std::vector<Footprint> footprints(std::size_t count) {
    std::vector<Footprint> all(count);
    for (std::size_t i = 0; i < count; ++i) all[i].x = static_cast<std::int64_t>(i);
    return all;
}

TEST(ChooseFilter, ANamedFilterIsTheOnlyStep) {
    const SamplePlan plan = choose_filter(probes, Accuracy::fast, {});
    EXPECT_EQ(plan.steps, (std::vector<SampleStep>{{probes, Accuracy::fast}}));
}

TEST(ChooseFilter, ExactIsTheExactFilterOnExactTexelsAtOnce) {
    const SamplePlan plan = choose_filter({}, Accuracy::exact, {});
    EXPECT_EQ(plan.steps, (std::vector<SampleStep>{{exact, Accuracy::exact}}));
}

TEST(ChooseFilter, AnErrorLimitIsWorthAnyFilterUpToExactOnesOnExactTexels) {
    for (const double codes : {0.0, 0.01, 5.0}) {
        const SamplePlan plan = choose_filter({}, Accuracy::fast, codes);
        EXPECT_EQ(plan.enough_codes, codes);
        EXPECT_GT(plan.steps.size(), 3u);
        EXPECT_EQ(plan.steps.back(), (SampleStep{exact, Accuracy::exact}));
        EXPECT_EQ(plan.steps.front().texels, Accuracy::fast);
    }
    // What few lines can keep they try first
    EXPECT_GT(choose_filter({}, Accuracy::high, 5).steps.size(),
              choose_filter({}, Accuracy::high, 0.5).steps.size());
}

TEST(ChooseFilter, WithoutALimitTheCostHasAnEnd) {
    for (const Accuracy accuracy : {Accuracy::fast, Accuracy::high})
        for (const SampleStep& step : choose_filter({}, accuracy, {}).steps) {
            EXPECT_EQ(step.filter.kind, FilterKind::line_integral);
            EXPECT_EQ(step.texels, accuracy);
        }
}

TEST(SampleBy, GoesOnOnlyWhereTheBoundIsTooLarge) {
    const SamplePlan plan{{{probes, Accuracy::fast}, {line, Accuracy::fast}, {exact, Accuracy::exact}}, 1};
    std::vector<std::vector<std::int64_t>> asked;
    const auto run = [&](const SampleStep& step, std::span<const Footprint> some,
                         std::span<FilteredSample> samples) -> Result<void> {
        asked.emplace_back();
        for (std::size_t i = 0; i < some.size(); ++i) {
            asked.back().push_back(some[i].x);
            const auto x = static_cast<double>(some[i].x);
            samples[i] = step.filter == probes ? sample(x, 1, 0.1F)      // 0 and 1 are good enough
                         : step.filter == line ? sample(x - 2, 1, 0.2F)  // 2 and 3
                                               : sample(x - 2.5, 1, 0.3F);
        }
        return {};
    };
    std::vector<FilteredSample> samples(5);
    std::vector<std::uint8_t> steps(5);
    ASSERT_TRUE(sample_by(plan, footprints(5), run, samples, steps));
    EXPECT_EQ(asked, (std::vector<std::vector<std::int64_t>>{{0, 1, 2, 3, 4}, {2, 3, 4}, {4}}));
    EXPECT_EQ(steps, (std::vector<std::uint8_t>{0, 0, 1, 1, 2}));
    EXPECT_EQ(samples[3].color[0], 0.2F);
    EXPECT_EQ(samples[4].bound_codes, 1.5);  // no step was good enough: the least bound
    EXPECT_EQ(samples[0].texels, 5u);
    EXPECT_EQ(samples[3].texels, 10u);
    EXPECT_EQ(samples[4].texels, 15u);
}

TEST(SampleBy, KeepsTheLeastBoundWhereALaterStepIsWorse) {
    const SamplePlan plan{{{line, Accuracy::fast}, {exact, Accuracy::fast}}, 0};
    const auto run = [](const SampleStep& step, std::span<const Footprint>,
                        std::span<FilteredSample> samples) -> Result<void> {
        samples[0] = step.filter == line ? sample(0.5, 1, 0.1F) : sample(0.75, 1, 0.2F);
        return {};
    };
    FilteredSample one;
    std::uint8_t step = 9;
    ASSERT_TRUE(sample_by(plan, footprints(1), run, {&one, 1}, {&step, 1}));
    EXPECT_EQ(one.color[0], 0.1F);
    EXPECT_EQ(step, 0);
    EXPECT_EQ(one.texels, 10u);
}

TEST(SampleBy, ABoundThatWasChosenAmongSeveralIsLessSureThanItSays) {
    const SamplePlan plan{{{probes, Accuracy::fast}, {line, Accuracy::fast}, {exact, Accuracy::fast}}, 1};
    const auto run = [](const SampleStep& step, std::span<const Footprint> some,
                        std::span<FilteredSample> samples) -> Result<void> {
        for (std::size_t i = 0; i < some.size(); ++i)
            samples[i] = step.filter == probes ? sample(9, 0.99, 0.1F)
                         : step.filter == line ? sample(some[i].x == 0 ? 0.5 : 9, 0.98, 0.2F)
                                               : sample(0.5, 1, 0.3F);
        return {};
    };
    std::vector<FilteredSample> samples(2);
    std::vector<std::uint8_t> steps(2);
    ASSERT_TRUE(sample_by(plan, footprints(2), run, samples, steps));
    EXPECT_NEAR(samples[0].confidence, 0.97, 1e-12);  // one in a hundred and two in a hundred
    EXPECT_EQ(samples[1].confidence, 1);              // a certain bound stays certain
}

TEST(SampleBy, EndsAtTheFirstError) {
    int runs = 0;
    const auto run = [&](const SampleStep&, std::span<const Footprint>,
                         std::span<FilteredSample>) -> Result<void> {
        ++runs;
        return Error{ErrorCode::timed_out, "late"};
    };
    FilteredSample one;
    std::uint8_t step = 0;
    const auto done =
        sample_by(choose_filter({}, Accuracy::high, {}), footprints(1), run, {&one, 1}, {&step, 1});
    EXPECT_EQ(done.error().code, ErrorCode::timed_out);
    EXPECT_EQ(runs, 1);
}

}  // namespace
}  // namespace tessera
