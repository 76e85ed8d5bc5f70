// `nested`: thresholds that are even in every aligned block (DESIGN section 2, "Nested thresholds").
#include <algorithm>
#include <bit>
#include <vector>

#include "server/blocks/generators.h"
#include "server/blocks/kernels.h"
#include "server/blocks/nested_thresholds.h"
#include "server/blocks/row_hash.h"

namespace tessera {

namespace {

class NestedOp final : public CellOp {
  public:
    NestedOp(std::uint64_t base, std::uint32_t count)
        : base_{base},
          count_{count},
          // Of 2^n alternatives the first bits say which
          digits_{std::has_single_bit(count) ? std::max(1, (std::countr_zero(count) + 1) / 2) : 16} {}

    bool scatters() const noexcept override { return false; }
    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        std::uint32_t thresholds[stretch_cells + max_reach];
        NestedThresholds{base_, stretch.z}.row(stretch.x, stretch.y, stretch.count, thresholds, digits_);
        for (std::int32_t i = 0; i < stretch.count; ++i)
            out[i] = static_cast<std::int32_t>(std::uint64_t{thresholds[i]} * count_ >> 32);
    }

  private:
    std::uint64_t base_;
    std::uint32_t count_;
    int digits_;
};

/// The keys of the nodes of height `j` over a stretch of cells, one for each cell.
struct NodeKeys {
    std::vector<std::uint32_t> first, second;
    std::uint64_t base = 0;
    std::int64_t x = 0, row = 0;
    std::int32_t cells = 0;

    void fetch(std::uint64_t of_base, int j, std::int64_t from, std::int64_t node_row, std::int32_t count) {
        if (base == of_base && x == from && row == node_row && cells >= count) return;
        base = of_base, x = from, row = node_row, cells = count;
        first.resize(static_cast<std::size_t>(count));
        second.resize(first.size());
        const std::int64_t side = std::int64_t{1} << j;
        for (std::int32_t done = 0; done < count;) {
            const std::int64_t at = from + done;
            const auto run =
                static_cast<std::int32_t>(std::min<std::int64_t>(count - done, side - (at & (side - 1))));
            const std::uint64_t key = hash(of_base, static_cast<std::uint64_t>(j), at >> j, node_row);
            std::fill_n(first.begin() + done, run, static_cast<std::uint32_t>(key));
            std::fill_n(second.begin() + done, run, static_cast<std::uint32_t>(key >> 32));
            done += run;
        }
    }
};

}  // namespace

NestedThresholds::NestedThresholds(std::uint64_t base, std::int64_t z) noexcept
    : base_{mix(base ^ stream("nested thresholds", static_cast<std::uint64_t>(z)))} {}

void NestedThresholds::row(std::int64_t x, std::int64_t y, std::int32_t cells, std::uint32_t* out,
                           int digits) const {
    // 2^j rows lie in the same nodes of height j
    thread_local std::vector<NodeKeys> kept;
    if (kept.size() < static_cast<std::size_t>(digits)) kept.resize(static_cast<std::size_t>(digits));
    std::fill_n(out, cells, 0u);
    for (int j = 1; j <= digits; ++j) {
        NodeKeys& keys = kept[static_cast<std::size_t>(j - 1)];
        keys.fetch(base_, j, x, y >> j, cells);
        const std::uint32_t down = (y >> (j - 1) & 1) != 0 ? 2 : 0;
        block_kernels().nest(keys.first.data(), keys.second.data(), static_cast<std::uint32_t>(x), j - 1,
                             down, cells, out);
    }
    if (digits < 16)
        for (std::int32_t i = 0; i < cells; ++i) out[i] <<= 32 - 2 * digits;
}

std::shared_ptr<const CellOp> make_nested_op(std::uint64_t seed, const CellDraw& draw) {
    return std::make_shared<NestedOp>(stream_base(seed, draw.key), draw.count);
}

}  // namespace tessera
