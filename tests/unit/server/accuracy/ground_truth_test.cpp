#include "server/accuracy/ground_truth.h"

#include <cmath>

#include <gmock/gmock.h>

#include "server/accuracy/measured_texture.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

View small_view(std::size_t which) { return view_of(situations(32, 28)[which]); }

GroundTruth known(const Result<GroundTruth>& truth) {
    EXPECT_TRUE(truth) << truth.error().detail;
    return truth.value();
}

TEST(GroundTruth, SampledIsWhereTheAnalyticIsWithinItsOwnError) {
    for (const MeasuredTexture& texture : {checker_texture(), text_texture()})
        for (std::size_t which = 0; which < 3; ++which) {
            const View view = small_view(which);
            const auto ignore = [](double) {};
            const GroundTruth analytic = known(ground_truth(view, texture.truth(), 4096, 2, {}, ignore));
            const GroundTruth sampled =
                known(ground_truth(view, {nullptr, texture.image, nullptr}, 4096, 2, {}, ignore));
            EXPECT_EQ(analytic.mse, 0);
            EXPECT_EQ(sampled.samples, 4096u);
            double squares = 0;
            for (std::size_t i = 0; i < view.pixels.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c) {
                    const double d = (sampled.linear[i][c] - analytic.linear[i][c]) * 255;
                    squares += d * d;
                }
            const double mse = squares / double(3 * view.pixels.size());
            // The error that the samples tell of themselves is the error they have
            EXPECT_GT(mse, sampled.mse_linear * 0.8) << texture.name << ' ' << which;
            EXPECT_LT(mse, sampled.mse_linear * 1.25) << texture.name << ' ' << which;
            EXPECT_LT(sampled.mse, 2) << texture.name << ' ' << which;
        }
}

TEST(GroundTruth, OfAConstantIsTheConstant) {
    const MeasuredTexture constant = constant_texture();
    const View view = small_view(2);
    for (const TruthSource& source : {constant.truth(), TruthSource{nullptr, constant.image, nullptr}}) {
        const GroundTruth truth = known(ground_truth(view, source, 4096, 2, {}, [](double) {}));
        for (const auto& color : truth.linear) EXPECT_NEAR(color[0], double(from_srgb(188)), 1e-6);
    }
}

TEST(GroundTruth, IsTheSameOnAnyNumberOfThreads) {
    const MeasuredTexture text = text_texture();
    const View view = small_view(0);
    const TruthSource source{nullptr, text.image, nullptr};
    EXPECT_EQ(known(ground_truth(view, source, 4096, 1, {}, [](double) {})).linear,
              known(ground_truth(view, source, 4096, 5, {}, [](double) {})).linear);
}

TEST(GroundTruth, StopsWhenAsked) {
    const MeasuredTexture text = text_texture();
    std::stop_source stop;
    stop.request_stop();
    const auto truth =
        ground_truth(small_view(1), {nullptr, text.image, nullptr}, 4096, 2, stop.get_token(), [](double) {});
    ASSERT_FALSE(truth);
    EXPECT_EQ(truth.error().code, ErrorCode::cancelled);
}

TEST(SampleTruth, OfATrapeziumCountsAreaAndNotParameters) {
    // Half black, half white by columns: the wide end of the trapezium counts more
    auto image = std::make_shared<LinearImage>(200, 2);
    for (std::int32_t y = 0; y < 2; ++y)
        for (std::int32_t x = 0; x < 200; ++x)
            for (std::int32_t c = 0; c < 4; ++c) image->row(y)[4 * x + c] = x < 100 ? 0.F : 1.F;
    const auto texels = truth_texels_of(std::shared_ptr<const LinearImage>{image});
    const Footprint trapezium{0, 0, {{{0, 0}, {200, 0}, {200, 30}, {0, 10}}}, 0};
    const auto color = sample_truth(trapezium, 2048, 7, *texels);
    ASSERT_TRUE(color);
    EXPECT_NEAR(color->color[0], 2500.0 / 4000, 0.002);
}

}  // namespace
}  // namespace tessera
