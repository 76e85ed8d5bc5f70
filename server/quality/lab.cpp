#include "server/quality/lab.h"

#include <array>
#include <cstddef>
#include <memory>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// CIELAB's function f of each linear step (CIE 15).
std::unique_ptr<std::array<float, 65536>> make_curve() {
    auto curve = std::make_unique<std::array<float, 65536>>();
    for (std::size_t step = 0; step < curve->size(); ++step) {
        const double t = double(step) / 65535.0;
        (*curve)[step] =
            static_cast<float>(t > 216.0 / 24389.0 ? std::cbrt(t) : t * (841.0 / 108.0) + 4.0 / 29.0);
    }
    return curve;
}

const std::array<float, 65536>& curve() noexcept {
    static const auto made = make_curve();
    return *made;
}

}  // namespace

// sRGB's primaries (IEC 61966-2-1) in XYZ over D65 white, in 65536ths: each row sums to one

float lightness_of(const std::uint8_t* codes) noexcept {
    const std::uint32_t y =
        13938U * srgb_to_steps[codes[0]] + 46868U * srgb_to_steps[codes[1]] + 4730U * srgb_to_steps[codes[2]];
    return 116 * curve()[y >> 16] - 16;
}

Lab to_lab(const std::uint8_t* codes) noexcept {
    const std::uint32_t red = srgb_to_steps[codes[0]];
    const std::uint32_t green = srgb_to_steps[codes[1]];
    const std::uint32_t blue = srgb_to_steps[codes[2]];
    const float x = curve()[(28440 * red + 24656 * green + 12440 * blue) >> 16];
    const float y = curve()[(13938 * red + 46868 * green + 4730 * blue) >> 16];
    const float z = curve()[(1164 * red + 7174 * green + 57198 * blue) >> 16];
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

}  // namespace tessera
