#pragma once

#include <cstring>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "server/blocks/plan.h"
#include "shared/math/hash.h"

namespace tessera::testing {

/// Cells that show looks[type], or, where `independent`, looks[a hash of the cell below their number].
class MadeProgram final : public CellProgram {
  public:
    MadeProgram(std::vector<Look> looks, bool independent, std::uint64_t seed = 1)
        : looks_{std::move(looks)}, independent_{independent}, seed_{seed} {}

    void patterns(const CellRow& row, std::int32_t* out) const override {
        for (std::int32_t i = 0; i < row.count; ++i) out[i] = look(row, i).pattern;
    }
    void looks(const CellRow& row, Look* out) const override {
        for (std::int32_t i = 0; i < row.count; ++i) out[i] = look(row, i);
    }
    Basis basis() const noexcept override { return independent_ ? Basis::stationary : Basis::typed; }
    bool needs_types() const noexcept override { return !independent_; }
    bool independent_cells() const noexcept override { return true; }
    Look look_of_type(std::uint16_t type) const override { return looks_[type]; }
    std::optional<VaryingMap> varying() const override { return {}; }
    std::vector<LookShare> shares(std::span<const std::int32_t>) const override {
        std::vector<LookShare> shares;
        for (const Look& look : looks_)
            shares.push_back({look.pattern, look.turn, look.scale, 1.0 / static_cast<double>(looks_.size())});
        return shares;
    }
    std::size_t memory_bytes() const noexcept override { return looks_.size() * sizeof(Look); }

  private:
    Look look(const CellRow& row, std::int32_t i) const {
        if (!independent_) return looks_[row.types[i]];
        const std::uint64_t bits =
            hash(seed_, stream("made", static_cast<std::uint64_t>(row.z)), row.x + i, row.y);
        return looks_[uniform_below(bits, static_cast<std::uint32_t>(looks_.size()))];
    }

    std::vector<Look> looks_;
    bool independent_;
    std::uint64_t seed_;
};

/// `count` looks whose numbers are drawn below the given ones; about one in five is blank.
inline std::vector<Look> made_looks(std::size_t count, std::uint32_t patterns, std::uint32_t turns,
                                    std::uint32_t scales, std::uint64_t seed = 3) {
    std::vector<Look> looks(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t bits = hash(seed, stream("looks"), static_cast<std::int64_t>(i), 0);
        const auto below = [&](std::uint32_t n) { return uniform_below(bits = mix(bits + 1), n); };
        looks[i].pattern = below(5) == 0 ? -1 : static_cast<std::int32_t>(below(patterns));
        looks[i].x = static_cast<std::uint16_t>(below(65536));
        looks[i].y = static_cast<std::uint16_t>(below(65536));
        looks[i].turn = static_cast<std::uint8_t>(below(turns));
        looks[i].scale = static_cast<std::uint8_t>(below(scales));
    }
    return looks;
}

/// Blobs of noise on a transparent ground; `opaque`: alpha 255 everywhere.
inline std::shared_ptr<const PatternImages> made_patterns(std::int32_t side, std::int32_t count,
                                                          std::int32_t slices = 1, bool opaque = false,
                                                          std::uint64_t seed = 5) {
    auto images = std::make_shared<PatternImages>();
    *images = {side, count, slices, {}};
    for (std::int32_t image = 0; image < count * slices; ++image)
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                const std::uint64_t bits = hash(seed, stream("texels", std::uint64_t(image)), x, y);
                const double dx = (x + 0.5) / side - 0.5, dy = (y + 0.5) / side - 0.5;
                const double alpha = (0.25 - dx * dx - dy * dy) * 2000;
                for (int c = 0; c < 3; ++c)
                    images->codes.push_back(static_cast<std::uint8_t>((bits >> 8 * c) & 255));
                images->codes.push_back(opaque ? 255
                                               : static_cast<std::uint8_t>(alpha < 0     ? 0
                                                                           : alpha > 255 ? 255
                                                                                         : alpha));
            }
    return images;
}

inline std::shared_ptr<const TransformPlan> made_transform(std::uint32_t turns, std::vector<double> scales,
                                                           bool overflow = false) {
    auto transform = std::make_shared<TransformPlan>();
    transform->overflow = overflow;
    for (std::uint32_t t = 0; t < turns; ++t) transform->turns.push_back(double(t) / turns);
    transform->scales = std::move(scales);
    return transform;
}

inline Grid made_grid(int cell_log2, std::uint32_t types = 256, std::uint64_t seed = 9,
                      std::int32_t cell_slices = 0) {
    return {"grid", cell_log2, cell_slices, std::make_shared<TypedQuadtree>(seed, types)};
}

}  // namespace tessera::testing
