// `nested`: thresholds that are even in every aligned block (DESIGN section 2, "Nested thresholds").
#include <algorithm>

#include "server/blocks/generators.h"
#include "server/blocks/kernels.h"
#include "server/blocks/nested_thresholds.h"
#include "server/blocks/row_hash.h"

namespace tessera {

namespace {

class NestedOp final : public CellOp {
  public:
    NestedOp(std::uint64_t base, std::uint32_t count) : base_{base}, count_{count} {}

    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        std::uint32_t thresholds[stretch_cells + max_reach];
        NestedThresholds{base_, stretch.z}.row(stretch.x, stretch.y, stretch.count, thresholds);
        for (std::int32_t i = 0; i < stretch.count; ++i)
            out[i] = static_cast<std::int32_t>(std::uint64_t{thresholds[i]} * count_ >> 32);
    }

  private:
    std::uint64_t base_;
    std::uint32_t count_;
};

}  // namespace

NestedThresholds::NestedThresholds(std::uint64_t base, std::int64_t z) noexcept
    : base_{mix(base ^ stream("nested thresholds", static_cast<std::uint64_t>(z)))} {}

void NestedThresholds::row(std::int64_t x, std::int64_t y, std::int32_t cells,
                           std::uint32_t* out) const noexcept {
    std::fill_n(out, cells, 0u);
    std::uint32_t first[stretch_cells + max_reach], second[stretch_cells + max_reach];
    for (int j = 1; j <= 16; ++j) {
        // The keys of the nodes of height j over the cells
        const std::int64_t mask = (std::int64_t{1} << j) - 1;
        for (std::int32_t done = 0; done < cells;) {
            const std::int64_t at = x + done;
            const auto run =
                static_cast<std::int32_t>(std::min<std::int64_t>(cells - done, mask + 1 - (at & mask)));
            const std::uint64_t key = hash(base_, static_cast<std::uint64_t>(j), at >> j, y >> j);
            std::fill_n(first + done, run, static_cast<std::uint32_t>(key));
            std::fill_n(second + done, run, static_cast<std::uint32_t>(key >> 32));
            done += run;
        }
        const std::uint32_t down = (y >> (j - 1) & 1) != 0 ? 2 : 0;
        block_kernels().nest(first, second, static_cast<std::uint32_t>(x), j - 1, down, cells, out);
    }
}

std::shared_ptr<const CellOp> make_nested_op(std::uint64_t seed, const CellDraw& draw) {
    return std::make_shared<NestedOp>(stream_base(seed, draw.key), draw.count);
}

}  // namespace tessera
