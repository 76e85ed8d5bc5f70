#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "server/accuracy/truth_texels.h"
#include "server/accuracy/two_color_pattern.h"
#include "shared/math/footprint.h"
#include "shared/math/image_error.h"
#include "shared/situations/situation.h"

namespace tessera {

/// The true average of a footprint, RGB in linear light, and how uncertain it is itself.
struct TrueColor {
    std::array<double, 3> color{};
    std::array<double, 3> variance{};  ///< Expected squared error; 0: analytic.
};

/// Stratified sampling of a footprint: 2·`strata` points of level 0, two anywhere in each of the strata,
/// which are about as wide as high in texels; weighted by area, so that the result is the mean over the
/// footprint and not over the pixel. The spread within the strata tells the error. `key` makes it repeatable.
/// `strata` is a power of two.
Result<TrueColor> sample_truth(const Footprint& footprint, std::size_t strata, std::uint64_t key,
                               TruthTexels& texels);

inline constexpr std::size_t least_truth_samples = 4096;

/// The pixels of a situation that have a footprint: what is measured.
struct View {
    Situation situation;
    std::vector<std::uint8_t> measured;  ///< width·height flags.
    std::vector<std::size_t> pixels;     ///< Those with a flag, in order.
    std::vector<Footprint> footprints;   ///< Of `pixels`.
};
View view_of(Situation situation);

/// A view on a texture as it should be.
struct GroundTruth {
    CodeImage codes;                            ///< Sky is sky_code.
    std::vector<std::array<double, 3>> linear;  ///< Of View::pixels.
    double mse = 0;           ///< Its own expected squared error in sRGB codes; 0: analytic.
    double mse_linear = 0;    ///< The same in codes of linear light.
    std::size_t samples = 0;  ///< A pixel; 0: analytic.
};
inline constexpr float sky_code = 128;

/// How to know the truth of a texture.
struct TruthSource {
    std::shared_ptr<const TwoColorPattern> analytic;  ///< Or null, and then:
    std::shared_ptr<const LinearImage> image;
    std::shared_ptr<const Texture> texture;
};

/// `advance` hears of fractions from 0 to 1, from any thread. Error: cancelled, or what evaluating says.
Result<GroundTruth> ground_truth(const View& view, const TruthSource& source, std::size_t samples,
                                 std::size_t threads, const std::stop_token& stop,
                                 const std::function<void(double)>& advance);

}  // namespace tessera
