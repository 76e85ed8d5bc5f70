#include "shared/math/image_error.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Bumps and waves with some noise: every scale has structure.
CodeImage picture(std::int32_t width, std::int32_t height, double noise, std::uint64_t seed = 1) {
    CodeImage image(width, height);
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x)
            for (std::int32_t c = 0; c < 3; ++c) {
                const double random =
                    double(hash(seed, stream("noise", std::uint64_t(c)), x, y) >> 11) * 0x1p-53 - 0.5;
                const double value = 128 + 60 * std::sin(x * 0.7) * std::cos(y * 0.45) +
                                     50 * std::sin((x + 2 * y) * 0.031 + c) + noise * random;
                image.pixel(x, y)[c] = static_cast<float>(std::clamp(value, 0.0, 255.0));
            }
    return image;
}

TEST(FractionalSrgbCode, PassesThroughEveryCode) {
    for (int code = 0; code < 256; ++code)
        EXPECT_NEAR(fractional_srgb_code(detail::decode(code)), code, 1e-4) << code;
    EXPECT_EQ(fractional_srgb_code(-0.5), 0);
    EXPECT_EQ(fractional_srgb_code(7.0), 255);
    EXPECT_EQ(fractional_srgb_code(std::nan("")), 0);
}

TEST(SrgbCodesPerLinear, IsTheSlopeOfTheCode) {
    for (const double linear : {0.0005, 0.002, 0.01, 0.18, 0.5, 0.95}) {
        const double step = linear * 1e-4;
        const double slope =
            (fractional_srgb_code(linear + step) - fractional_srgb_code(linear - step)) / (2 * step);
        EXPECT_NEAR(srgb_codes_per_linear(linear) / slope, 1, 1e-3) << linear;
    }
}

TEST(ImageError, OfEqualPicturesIsNone) {
    const CodeImage image = picture(64, 40, 20);
    const ImageError error = image_error(image, image);
    EXPECT_EQ(error.mse, 0);
    EXPECT_EQ(error.psnr, most_psnr);
    EXPECT_EQ(error.ms_ssim, 1);
    EXPECT_EQ(error.max_error, 0);
}

TEST(ImageError, CountsSquaresDecibelsAndTheWorstPixel) {
    const CodeImage truth = picture(32, 32, 0);
    CodeImage image = truth;
    for (float& code : image.codes) code += 2;
    image.pixel(5, 7)[1] += 10;
    const ImageError error = image_error(truth, image);
    const double mse = 4 + (12.0 * 12 - 4) / (32 * 32 * 3);
    EXPECT_NEAR(error.mse, mse, 1e-4);
    EXPECT_NEAR(error.psnr, 10 * std::log10(255 * 255 / mse), 1e-4);
    EXPECT_NEAR(error.max_error, 12, 1e-4);
}

TEST(ImageError, PixelsThatAreNotMeasuredCountForNothing) {
    const CodeImage truth = picture(200, 190, 10);
    CodeImage image = truth, wrong_everywhere = truth;
    std::vector<std::uint8_t> measured(200 * 190, 1);
    for (std::int32_t y = 0; y < 60; ++y)
        for (std::int32_t x = 0; x < 200; ++x) {
            measured[std::size_t(y * 200 + x)] = 0;
            for (std::int32_t c = 0; c < 3; ++c) image.pixel(x, y)[c] = 0;
        }
    EXPECT_GT(image_error(truth, image).mse, 1000);
    EXPECT_EQ(image_error(truth, image, measured).mse, 0);
    EXPECT_EQ(image_error(truth, image, measured).ms_ssim, 1);
    for (float& code : wrong_everywhere.codes) code = 255 - code;
    const std::vector<std::uint8_t> none(200 * 190, 0);
    EXPECT_EQ(image_error(truth, wrong_everywhere, none).mse, 0);
}

TEST(MsSsim, FallsAsNoiseGrows) {
    const CodeImage truth = picture(208, 182, 0);
    double before = 1;
    for (const double noise : {2.0, 8.0, 32.0, 128.0}) {
        const double value = ms_ssim(truth, picture(208, 182, noise));
        EXPECT_LT(value, before) << noise;
        EXPECT_GT(value, 0) << noise;
        before = value;
    }
}

TEST(MsSsim, BlurCostsMoreThanAnEqualShiftOfLight) {
    const CodeImage truth = picture(208, 182, 40);
    CodeImage blurred(208, 182), lighter = truth;
    for (std::int32_t y = 0; y < 182; ++y)
        for (std::int32_t x = 0; x < 208; ++x)
            for (std::int32_t c = 0; c < 3; ++c) {
                double sum = 0;
                for (std::int32_t v = -1; v <= 1; ++v)
                    for (std::int32_t u = -1; u <= 1; ++u)
                        sum += double(truth.pixel(std::clamp(x + u, 0, 207), std::clamp(y + v, 0, 181))[c]);
                blurred.pixel(x, y)[c] = static_cast<float>(sum / 9);
            }
    const auto shift = static_cast<float>(std::sqrt(image_error(truth, blurred).mse));
    for (float& code : lighter.codes) code += shift;
    EXPECT_LT(ms_ssim(truth, blurred), ms_ssim(truth, lighter) - 0.005);
}

/// The definition at one scale, window by window, for a picture that holds only one scale.
TEST(MsSsim, OfOneScaleIsTheDefinition) {
    const CodeImage a = picture(17, 14, 30, 1), b = picture(17, 14, 90, 2);
    const auto luma = [](const CodeImage& image, int x, int y) {
        const float* p = image.pixel(x, y);
        return 0.299 * double(p[0]) + 0.587 * double(p[1]) + 0.114 * double(p[2]);
    };
    double luminance = 0, structure = 0;
    int windows = 0;
    for (int y = 5; y + 5 < 14; ++y)
        for (int x = 5; x + 5 < 17; ++x, ++windows) {
            double weights = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
            for (int v = -5; v <= 5; ++v)
                for (int u = -5; u <= 5; ++u) {
                    const double w = std::exp(-(u * u + v * v) / 4.5), pa = luma(a, x + u, y + v),
                                 pb = luma(b, x + u, y + v);
                    weights += w;
                    ma += w * pa;
                    mb += w * pb;
                    aa += w * pa * pa;
                    bb += w * pb * pb;
                    ab += w * pa * pb;
                }
            ma /= weights;
            mb /= weights;
            luminance += (2 * ma * mb + 6.5025) / (ma * ma + mb * mb + 6.5025);
            structure += (2 * (ab / weights - ma * mb) + 58.5225) /
                         (aa / weights - ma * ma + bb / weights - mb * mb + 58.5225);
        }
    EXPECT_NEAR(ms_ssim(a, b), std::pow(luminance / windows * structure / windows, 1.0001), 1e-9);
}

TEST(MsSsim, OfAPictureTooSmallForAWindowIsAllOrNothing) {
    EXPECT_EQ(ms_ssim(picture(10, 40, 0), picture(10, 40, 0)), 1);
    EXPECT_EQ(ms_ssim(picture(10, 40, 0), picture(10, 40, 30)), 0);
}

}  // namespace
}  // namespace tessera
