// `nested`: thresholds that are even in every aligned block (DESIGN section 2, "Nested thresholds").
#include <array>

#include "server/blocks/generators.h"
#include "server/blocks/nested_thresholds.h"
#include "server/blocks/row_hash.h"

namespace tessera {

namespace {

/// The 24 permutations of four quadrants, two bits each.
constexpr std::array<std::uint8_t, 24> permutations = [] {
    std::array<std::uint8_t, 24> all{};
    std::size_t count = 0;
    for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = 0; b < 4; ++b)
            for (unsigned c = 0; c < 4; ++c) {
                if (a == b || a == c || b == c) continue;
                const unsigned d = 6 - a - b - c;
                all[count++] = static_cast<std::uint8_t>(a | b << 2 | c << 4 | d << 6);
            }
    return all;
}();

class NestedOp final : public CellOp {
  public:
    NestedOp(std::uint64_t base, std::uint32_t count) : base_{base}, count_{count} {}

    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        const NestedThresholds thresholds{base_, stretch.z};
        for (std::int32_t i = 0; i < stretch.count; ++i)
            out[i] = static_cast<std::int32_t>(
                std::uint64_t{thresholds.at(stretch.x + i, stretch.y)} * count_ >> 32);
    }

  private:
    std::uint64_t base_;
    std::uint32_t count_;
};

}  // namespace

NestedThresholds::NestedThresholds(std::uint64_t base, std::int64_t z) noexcept
    : base_{mix(base ^ stream("nested thresholds", static_cast<std::uint64_t>(z)))} {}

std::uint32_t NestedThresholds::at(std::int64_t x, std::int64_t y) const noexcept {
    // d_j = π[hash(seed, stream, j, node_j, d_1 … d_(j−1))](q_j)
    std::uint32_t digits = 0;
    for (int j = 1; j <= 16; ++j) {
        const auto quadrant = static_cast<unsigned>((x >> (j - 1) & 1) | (y >> (j - 1) & 1) << 1);
        const std::uint64_t chosen =
            hash(base_, static_cast<std::uint64_t>(j) << 32 | digits, x >> j, y >> j);
        const std::uint8_t permutation = permutations[(chosen >> 32) * 24 >> 32];
        digits = digits << 2 | (permutation >> (2 * quadrant) & 3u);
    }
    return digits;
}

std::shared_ptr<const CellOp> make_nested_op(std::uint64_t seed, const CellDraw& draw) {
    return std::make_shared<NestedOp>(stream_base(seed, draw.key), draw.count);
}

}  // namespace tessera
