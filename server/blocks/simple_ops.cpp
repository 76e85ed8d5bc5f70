#include "server/blocks/simple_ops.h"

#include <algorithm>

namespace tessera {

namespace {

class ConstantOp final : public CellOp {
  public:
    explicit ConstantOp(std::int32_t value) : value_{value} {}
    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        std::fill_n(out, stretch.count, value_);
    }

  private:
    std::int32_t value_;
};

class ScaleOp final : public CellOp {
  public:
    explicit ScaleOp(std::int32_t factor) : factor_{factor} {}
    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override {
        const std::int32_t* values = in[0];
        for (std::int32_t i = 0; i < stretch.count; ++i) out[i] = values[i] * factor_;
    }

  private:
    std::int32_t factor_;
};

}  // namespace

std::shared_ptr<const CellOp> make_constant_op(std::int32_t value) {
    return std::make_shared<ConstantOp>(value);
}

std::shared_ptr<const CellOp> make_scale_op(std::int32_t factor) { return std::make_shared<ScaleOp>(factor); }

}  // namespace tessera
