#include "server/texture/texture.h"

#include <algorithm>

#include "shared/math/srgb.h"

namespace tessera {

void encode(const LinearImage& linear, Rgba8Image& out) {
    out.width = linear.width;
    out.height = linear.height;
    out.bytes.resize(linear.values.size());
    const std::uint8_t* codes = steps_to_srgb_codes();
    // Some texels at a time, so that the arithmetic runs in vectors and only look-ups do not
    constexpr std::size_t at_once = 256;
    std::int32_t steps[at_once];
    for (std::size_t from = 0; from < linear.values.size(); from += at_once) {
        const std::size_t count = std::min(at_once, linear.values.size() - from);
        const float* values = linear.values.data() + from;
        std::uint8_t* bytes = out.bytes.data() + from;
        for (std::size_t i = 0; i < count; ++i) steps[i] = to_steps(values[i]);
        for (std::size_t i = 0; i < count; i += 4) {
            for (std::size_t channel = 0; channel < 3; ++channel)
                bytes[i + channel] = codes[steps[i + channel]];
            // Alpha is a coverage, not a colour: linear in its code
            bytes[i + 3] = static_cast<std::uint8_t>(
                (static_cast<std::uint32_t>(steps[i + 3]) * 255u + 32767u) / 65535u);
        }
    }
}

void encode_data(const LinearImage& values, Rgba8Image& out) {
    out = Rgba8Image{values.width, values.height};
    encode_data(values.values.data(), values.values.size(), out.bytes.data());
}

void encode_data(const float* values, std::size_t count, std::uint8_t* codes) {
    for (std::size_t i = 0; i < count; ++i) {
        const float scaled = values[i] * 255.0F + 0.5F;
        codes[i] = static_cast<std::uint8_t>(scaled > 0.0F ? (scaled < 255.0F ? scaled : 255.0F) : 0.0F);
    }
}

Result<Evaluation> Texture::evaluate(const TexelRegion& region, const Budget& budget, Rgba8Image& out) const {
    LinearImage linear;
    const auto evaluation = evaluate(region, budget, linear);
    if (evaluation) texel_kind() == TexelKind::data ? encode_data(linear, out) : encode(linear, out);
    return evaluation;
}

Result<void> check_budget(const Budget& budget) {
    if (budget.cancelled.stop_requested())
        return Error{ErrorCode::cancelled, "nobody waits for this page any more"};
    if (budget.deadline != std::chrono::steady_clock::time_point::max() &&
        std::chrono::steady_clock::now() > budget.deadline)
        return Error{ErrorCode::timed_out, "the evaluation's deadline passed"};
    return {};
}

}  // namespace tessera
