#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

/// The sRGB code of linear light as a number between codes: 0 to 255, not rounded; clamped, NaN is 0.
double fractional_srgb_code(double linear) noexcept;

/// How many codes a small change of linear light is worth there.
double srgb_codes_per_linear(double linear) noexcept;

/// A picture as its errors are judged: RGB in sRGB codes, 0 to 255, fractions kept; rows from the top.
struct CodeImage {
    std::int32_t width = 0, height = 0;
    std::vector<float> codes;  ///< 3·width·height

    CodeImage() = default;
    CodeImage(std::int32_t w, std::int32_t h)
        : width{w}, height{h}, codes(std::size_t(w) * std::size_t(h) * 3) {}
    float* pixel(std::int32_t x, std::int32_t y) noexcept {
        return codes.data() + 3 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
    }
    const float* pixel(std::int32_t x, std::int32_t y) const noexcept {
        return codes.data() + 3 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
    }
};

struct ImageError {
    double mse = 0;        ///< Codes², mean over pixels and channels.
    double psnr = 0;       ///< dB below 255; most_psnr where there is no error.
    double ms_ssim = 1;    ///< 0 to 1; see below.
    double max_error = 0;  ///< Codes.
};

inline constexpr double most_psnr = 200;

/// Both pictures have one size. `measured`: a flag for each pixel; those without one (sky) count for nothing;
/// empty: all count. Where none counts there is no error.
ImageError image_error(const CodeImage& truth, const CodeImage& picture,
                       std::span<const std::uint8_t> measured = {});

/// Multi-scale structural similarity of luma (Wang, Simoncelli, Bovik, "Multiscale structural similarity for
/// image quality assessment", Asilomar 2003): 11×11 Gaussian windows of σ 1.5, constants 0.01 and 0.03, five
/// scales with the paper's exponents. Windows count whose middle counts. A picture below 176 pixels has as
/// many scales as hold a window, their exponents scaled to the same sum; below 11 pixels it is 1 if all is
/// equal, else 0.
double ms_ssim(const CodeImage& truth, const CodeImage& picture, std::span<const std::uint8_t> measured = {});

}  // namespace tessera
