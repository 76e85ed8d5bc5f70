// `typed`: the cell's type in the quadtree decides (DESIGN section 2, "Choices").
#include <numeric>
#include <vector>

#include "server/blocks/generators.h"
#include "server/blocks/kernels.h"
#include "shared/math/hash.h"

namespace tessera {

namespace {

class TypeTableOp final : public CellOp {
  public:
    explicit TypeTableOp(std::vector<std::int32_t> table)
        : table_{std::move(table)}, kernels_{block_kernels()} {}

    bool scatters() const noexcept override { return false; }
    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        kernels_.look_up_types(table_.data(), stretch.types, stretch.count, out);
    }
    std::size_t memory_bytes() const noexcept override { return table_.size() * sizeof table_[0]; }

  private:
    std::vector<std::int32_t> table_;
    const BlockKernels& kernels_;
};

}  // namespace

std::shared_ptr<const CellOp> make_typed_op(std::uint64_t seed, const CellDraw& draw) {
    // A shuffle of the types (Fisher and Yates); the place of a type, scaled to the count, is its draw
    std::vector<std::int32_t> places(draw.types);
    std::iota(places.begin(), places.end(), 0);
    for (std::uint32_t i = draw.types - 1; i > 0; --i)
        std::swap(places[i], places[uniform_below(hash(seed, draw.key, i, 0), i + 1)]);
    for (std::int32_t& place : places)
        place = static_cast<std::int32_t>(std::uint64_t{static_cast<std::uint32_t>(place)} * draw.count /
                                          draw.types);
    return std::make_shared<TypeTableOp>(std::move(places));
}

}  // namespace tessera
