#include "server/filter/footprint_sampler.h"

#include <algorithm>
#include <cmath>

#include "server/filter/each_footprint.h"

namespace tessera {

namespace {

constexpr double codes_per_step = 255.0 / 65535.0;

}  // namespace

FilteredSample sample_of(const Estimate& estimate, const Reading& reading) noexcept {
    constexpr double parts = 256;  // 65535·256 < 2^24: a float holds every one
    FilteredSample sample;
    for (int c = 0; c < 4; ++c) {
        const double rounded = std::clamp(estimate.steps[c] * parts + 0.5, 0.0, 65535 * parts);
        sample.color[static_cast<std::size_t>(c)] =
            static_cast<float>(static_cast<std::int32_t>(rounded)) / static_cast<float>(65535 * parts);
    }
    sample.bound_codes = std::min(255.0, estimate.bound_codes + reading.bound_codes + codes_per_step / parts);
    sample.confidence = estimate.confidence * reading.confidence;
    sample.texels = reading.texels;
    return sample;
}

double bound_of_any(const Doubles4& steps) noexcept {
    double furthest = 0;
    for (int c = 0; c < 4; ++c) furthest = std::max({furthest, steps[c], 65535 - steps[c]});
    return furthest * codes_per_step;
}

std::unique_ptr<FootprintSampler> make_sampler(const FootprintFilter& filter,
                                               std::shared_ptr<const TexelPages> pages,
                                               std::size_t memory_bytes) {
    switch (filter.kind) {
        case FilterKind::nearest:
            return make_nearest(filter, std::move(pages), memory_bytes);
        case FilterKind::bilinear:
            return make_bilinear(filter, std::move(pages), memory_bytes);
        case FilterKind::trilinear:
            return make_trilinear(filter, std::move(pages), memory_bytes);
        case FilterKind::anisotropic:
            return make_anisotropic(filter, std::move(pages), memory_bytes);
        case FilterKind::ewa:
            return make_ewa(filter, std::move(pages), memory_bytes);
        case FilterKind::summed_area:
            return make_summed_area(filter, std::move(pages), memory_bytes);
        case FilterKind::line_integral:
            return make_line_integral(filter, std::move(pages), memory_bytes);
        case FilterKind::supersampling_grid:
        case FilterKind::supersampling_jittered:
            return make_supersampling(filter, std::move(pages), memory_bytes);
        case FilterKind::exact:
            break;
    }
    return make_exact(filter, std::move(pages), memory_bytes);
}

}  // namespace tessera
