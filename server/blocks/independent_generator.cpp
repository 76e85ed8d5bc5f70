// `independent`: the paper's virtual indirection map (3.2) with a counter hash in place of its permutations.
#include <algorithm>

#include "server/blocks/generators.h"
#include "server/blocks/kernels.h"

namespace tessera {

namespace {

class IndependentOp final : public CellOp {
  public:
    IndependentOp(std::uint64_t base, std::uint32_t count)
        : base_{base}, count_{count}, kernels_{block_kernels()} {}

    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        constexpr std::int64_t mask = (std::int64_t{1} << row_log2) - 1;
        if (const CellAt* at = stretch.scattered) {
            // Most follow each other in a row
            RowKey key;
            std::int64_t part = 0, row = 0;
            for (std::int32_t i = 0; i < stretch.count; ++i, ++at) {
                if (i == 0 || row != at->y || part != at->x >> row_log2) {
                    row = at->y, part = at->x >> row_log2;
                    key = row_key(base_, at->x, row, stretch.z);
                }
                kernels_.draw(key, static_cast<std::uint32_t>(at->x & mask), 1, count_, out + i);
            }
            return;
        }
        for (std::int32_t done = 0; done < stretch.count;) {
            const std::int64_t x = stretch.x + done;
            const auto run = static_cast<std::int32_t>(
                std::min<std::int64_t>(stretch.count - done, mask + 1 - (x & mask)));
            kernels_.draw(row_key(base_, x, stretch.y, stretch.z), static_cast<std::uint32_t>(x & mask), run,
                          count_, out + done);
            done += run;
        }
    }

  private:
    std::uint64_t base_;
    std::uint32_t count_;
    const BlockKernels& kernels_;
};

}  // namespace

std::shared_ptr<const CellOp> make_independent_op(const CellDraw& draw) {
    return std::make_shared<IndependentOp>(draw.base, draw.count);
}

}  // namespace tessera
