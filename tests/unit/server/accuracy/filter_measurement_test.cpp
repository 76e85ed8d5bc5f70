#include "server/accuracy/filter_measurement.h"

#include <ctime>

#include <gmock/gmock.h>

#include "server/accuracy/measured_texture.h"
#include "server/accuracy/row_pictures.h"

namespace tessera {
namespace {

using testing::ElementsAre;

/// Answers with the truth, a shift and a price.
class MadeSampler final : public FootprintSampler {
  public:
    MadeSampler(const TwoColorPattern& pattern, float shift, int microseconds)
        : ink_{pattern}, shift_{shift}, time_{double(microseconds)} {}
    Result<void> sample(std::span<const Footprint> footprints, const Budget& budget,
                        std::span<FilteredSample> samples) override {
        for (std::size_t i = 0; i < footprints.size(); ++i) {
            if (const auto done = check_budget(budget); !done) return done.error();
            const auto value = static_cast<float>(1 - ink_.share(footprints[i])) + shift_;
            samples[i] = {{value, value, value, 1}, 0.5, 1, 40};
            const double until = processor_microseconds() + time_;
            while (processor_microseconds() < until) {
            }
        }
        return {};
    }

  private:
    static double processor_microseconds() {
        timespec now{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
        return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
    }
    InkIntegral ink_;
    float shift_;
    double time_;
};

MeasuredFilter made(std::string name, float shift, int microseconds) {
    return {std::move(name), [shift, microseconds] {
                return std::make_unique<MadeSampler>(*checker_texture().pattern, shift, microseconds);
            }};
}

struct Measured {
    View view = view_of(situations(48, 42)[1]);
    GroundTruth truth = ground_truth(view, checker_texture().truth(), 4096, 2, {}, [](double) {}).value();
    MeasureOptions options{.rounds = 3, .round_seconds = 0.002, .budget = {}};
};

TEST(MeasureFilters, TellsErrorTimeAndTexels) {
    const Measured at;
    const auto found = measure_filters(at.view, at.truth, {made("right", 0, 2), made("off", 0.01F, 40)},
                                       at.options, [](double) {});
    ASSERT_TRUE(found) << found.error().detail;
    const FilterMeasurement &right = (*found)[0], &off = (*found)[1];
    EXPECT_LT(right.error.mse, 1e-6);
    EXPECT_GT(right.error.ms_ssim, 0.999999);
    EXPECT_EQ(right.pixels, at.view.pixels.size());
    EXPECT_EQ(right.texels_per_sample, 40);
    EXPECT_EQ(right.beyond_bound, 0);
    // A hundredth of linear light is 2.55 codes of it, beyond the half that was promised
    EXPECT_NEAR(off.mse_linear, 2.55 * 2.55, 0.01);
    EXPECT_NEAR(off.beyond_bound, 2.05, 0.01);
    EXPECT_GE(off.nanoseconds_per_sample, 40'000);
    EXPECT_GT(off.nanoseconds_per_sample, 3 * right.nanoseconds_per_sample);
}

TEST(MeasureFilters, AsksASlowFilterForFewerPixels) {
    Measured at;
    at.options.picture_seconds = 0.01;
    const auto found =
        measure_filters(at.view, at.truth, {made("slow", 0.01F, 200)}, at.options, [](double) {});
    ASSERT_TRUE(found);
    EXPECT_LT(found->front().pixels, at.view.pixels.size());
    EXPECT_GE(found->front().pixels, 16u);
    EXPECT_TRUE(found->front().picture.codes.empty());
    EXPECT_NEAR(found->front().mse_linear, 2.55 * 2.55, 0.01);
}

TEST(MeasureFilters, StopsWhenAsked) {
    Measured at;
    std::stop_source stop;
    stop.request_stop();
    at.options.budget.cancelled = stop.get_token();
    const auto found = measure_filters(at.view, at.truth, {made("any", 0, 1)}, at.options, [](double) {});
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::cancelled);
}

TEST(ParetoFront, HoldsWhatNothingBeats) {
    EXPECT_THAT(pareto_front({1, 2, 3, 4}, {9, 5, 7, 1}), ElementsAre(true, true, false, true));
    EXPECT_THAT(pareto_front({1, 1}, {2, 2}), ElementsAre(true, true));
    EXPECT_THAT(pareto_front({1, 1}, {2, 1}), ElementsAre(false, true));
}

TEST(ShownCounts, AreGreenBelowRedAboveAndGreyWhereMagnified) {
    const View view = view_of(situations(48, 42)[1]);
    FilterMeasurement measurement;
    for (std::size_t i = 0; i < view.pixels.size(); ++i)
        measurement.texels.push_back(i < view.pixels.size() / 2 ? 1 : 100'000);
    const Rgba8Image map = shown_counts(view, measurement);
    ASSERT_GT(map.height, 42);
    const std::uint8_t* few = map.bytes.data() + 4 * view.pixels.front();
    EXPECT_GT(few[1], few[0]);
    bool red = false;
    for (std::size_t i = view.pixels.size() / 2; i < view.pixels.size(); ++i) {
        const std::uint8_t* p = map.bytes.data() + 4 * view.pixels[i];

        if (area_of(view.footprints[i]) < 1) {
            EXPECT_EQ(p[0], p[1]);
        } else {
            EXPECT_GT(p[0], p[1]);
            red = true;
        }
    }
    EXPECT_TRUE(red);
}

}  // namespace
}  // namespace tessera
