#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>

#include "shared/motion/validity.h"
#include "shared/page/accuracy.h"
#include "shared/page/page_key.h"
#include "shared/page/texel_image.h"
#include "shared/result/result.h"

namespace tessera {

/// What one evaluation may cost. An evaluation looks at both limits about once a row.
struct Budget {
    Accuracy accuracy = Accuracy::high;
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
    std::stop_token cancelled{};
};

/// What an evaluation did.
struct Evaluation {
    std::string_view
        method;  ///< A word for headers and reports: "constant", "stamps", "variants", "quadtree", …
    double bound_codes =
        0;  ///< No texel is further from the exact box filter, in 8-bit codes of linear light.
    double confidence = 1;  ///< 1: the bound is certain; less: it holds with this probability for each texel.
    std::uint64_t work =
        0;                ///< Stamps, table rows or cells summed: a measure of cost that no clock disturbs.
    Validity validity{};  ///< Every step in it gives these bits; at its end a cell shows another frame.
};

/// A compiled texture: answers any rectangle of any level of the infinite lattice, exactly filtered where its
/// method allows. Immutable and shared between threads. The same arguments give the same bits on every
/// machine.
class Texture {
  public:
    virtual ~Texture() = default;
    Texture() = default;
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;

    /// Linear, premultiplied texels of `region`. `region.level` is at most max_level; sides are 1 to 4096.
    /// Errors: cancelled, timed_out.
    virtual Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                        LinearImage& out) const = 0;

    /// The same, coded as pages carry texels of texel_kind(). Equal to encode(evaluate(…)), or of data to
    /// encode_data(evaluate(…)), within the rounding of a linear step.
    virtual Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                        Rgba8Image& out) const;

    /// Whether texels are numbers and no colours.
    virtual TexelKind texel_kind() const noexcept { return TexelKind::color; }

    /// "constant", "checker", "content_exchange": the field of proto::Scene.
    virtual std::string_view kind() const noexcept = 0;

    /// What `tessera check` prints: the plan, a line each, and what it holds in memory.
    virtual std::string description() const = 0;
    virtual std::size_t memory_bytes() const noexcept = 0;
};

/// sRGB-codes linear texels, each channel clamped and rounded to the nearest code.
void encode(const LinearImage& linear, Rgba8Image& out);

/// The nearest 255th of each value, clamped.
void encode_data(const LinearImage& values, Rgba8Image& out);

void encode_data(const float* values, std::size_t count, std::uint8_t* codes);

/// The part of a code that error bounds count in: 1/255 of linear light.
inline constexpr double code_in_linear = 1.0 / 255.0;

/// cancelled or timed_out if the budget is spent; no error otherwise.
Result<void> check_budget(const Budget& budget);

}  // namespace tessera
