#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "server/blocks/plan.h"
#include "shared/math/hash.h"
#include "shared/page/page_key.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// Patterns of random texels: as far from each other as their colours allow.
inline PatternImages made_patterns(std::int32_t side, std::int32_t count, std::int32_t slices = 1,
                                   bool opaque = false, std::uint64_t seed = 1) {
    PatternImages images{side, count, slices, {}};
    images.codes.resize(std::size_t(side) * std::size_t(side) * std::size_t(count) * std::size_t(slices) * 4);
    const std::size_t image_bytes = std::size_t(side) * std::size_t(side) * 4;
    for (std::size_t i = 0; i < images.codes.size(); ++i) {
        const auto image = static_cast<std::int64_t>(i / image_bytes);
        const std::uint64_t level = hash(seed, stream("level"), image, static_cast<std::int64_t>(i % 4)) % 2;
        const std::uint64_t noise = hash(seed, stream("texel"), static_cast<std::int64_t>(i), 0) % 128;
        images.codes[i] = static_cast<std::uint8_t>(opaque && i % 4 == 3 ? 255 : level * 127 + noise);
    }
    return images;
}

/// Decisions that a test writes as functions of the cell.
class MadeProgram final : public CellProgram {
  public:
    using Patterns =
        std::function<std::int32_t(std::int64_t x, std::int64_t y, std::int64_t z, std::uint16_t type)>;
    using Shares = std::function<std::vector<LookShare>(std::span<const std::int32_t>)>;

    Basis made_basis = Basis::stationary;
    Patterns pattern_of;
    Shares shares_of = [](std::span<const std::int32_t>) { return std::vector<LookShare>{}; };
    std::optional<VaryingMap> map;
    bool typed = false;
    bool independent = true;

    void patterns(const CellRow& row, std::int32_t* out) const override {
        for (std::int32_t i = 0; i < row.count; ++i)
            out[i] =
                pattern_of(row.x + i, row.y, row.z, row.types != nullptr ? row.types[i] : std::uint16_t{0});
    }
    void looks(const CellRow& row, Look* out) const override {
        for (std::int32_t i = 0; i < row.count; ++i)
            out[i].pattern =
                pattern_of(row.x + i, row.y, row.z, row.types != nullptr ? row.types[i] : std::uint16_t{0});
    }
    Basis basis() const noexcept override { return made_basis; }
    bool needs_types() const noexcept override { return typed; }
    bool independent_cells() const noexcept override { return independent; }
    Look look_of_type(std::uint16_t type) const override { return {.pattern = pattern_of(0, 0, 0, type)}; }
    std::optional<VaryingMap> varying() const override { return map; }
    std::vector<LookShare> shares(std::span<const std::int32_t> states) const override {
        return shares_of(states);
    }
    std::size_t memory_bytes() const noexcept override { return sizeof *this; }
};

/// A grid with a quadtree where `types` is not 0.
inline Grid made_grid(int cell_log2, std::uint32_t types = 0, std::int32_t cell_slices = 0,
                      std::uint64_t seed = 7) {
    return {"tiles", cell_log2, cell_slices,
            types == 0 ? nullptr : std::make_shared<const TypedQuadtree>(seed, types)};
}

/// Typed cells of side 2^cell_log2: type t shows pattern t mod count.
inline ReferencePlan made_typed_plan(PatternImages images, std::uint32_t types,
                                     std::int32_t cell_slices = 0) {
    auto program = std::make_shared<MadeProgram>();
    program->made_basis = CellProgram::Basis::typed;
    program->typed = true;
    program->pattern_of = [count = images.count](std::int64_t, std::int64_t, std::int64_t,
                                                 std::uint16_t type) {
        return static_cast<std::int32_t>(type) % count;
    };
    int log2 = 0;
    while (std::int32_t{1} << log2 < images.side) ++log2;
    return {made_grid(log2, types, cell_slices), std::make_shared<const PatternImages>(std::move(images)),
            program, nullptr};
}

/// Means of 2×2 texels: what the level above shows.
inline LinearImage halved(const LinearImage& image) {
    LinearImage half{image.width / 2, image.height / 2};
    for (std::int32_t y = 0; y < half.height; ++y)
        for (std::int32_t x = 0; x < half.width * 4; ++x) {
            const std::int32_t at = (x / 4) * 8 + x % 4;
            const double sum = double{image.row(2 * y)[at]} + double{image.row(2 * y)[at + 4]} +
                               double{image.row(2 * y + 1)[at]} + double{image.row(2 * y + 1)[at + 4]};
            half.row(y)[x] = static_cast<float>(sum / 4);
        }
    return half;
}

/// The region of the level below that covers the same ground.
inline TexelRegion children_of(const TexelRegion& region) {
    TexelRegion below = region;
    below.level = static_cast<std::uint8_t>(region.level - 1);
    below.x *= 2;
    below.y *= 2;
    below.width *= 2;
    below.height *= 2;
    return below;
}

/// The largest difference, in codes of linear light.
inline double difference_codes(const LinearImage& a, const LinearImage& b) {
    double largest = a.width == b.width && a.height == b.height ? 0 : 1e9;
    for (std::size_t i = 0; i < a.values.size() && i < b.values.size(); ++i)
        largest = std::max(largest, std::abs(double{a.values[i]} - double{b.values[i]}) * 255);
    return largest;
}

/// The largest difference of 8-bit codes.
inline int difference_of_codes(const Rgba8Image& a, const Rgba8Image& b) {
    int largest = a.width == b.width && a.height == b.height ? 0 : 256;
    for (std::size_t i = 0; i < a.bytes.size() && i < b.bytes.size(); ++i)
        largest = std::max(largest, std::abs(int{a.bytes[i]} - int{b.bytes[i]}));
    return largest;
}

}  // namespace tessera
