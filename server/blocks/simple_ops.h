#pragma once

#include <memory>

#include "server/blocks/cell_op.h"

namespace tessera {

std::shared_ptr<const CellOp> make_constant_op(std::int32_t value);
/// The input times `factor`.
std::shared_ptr<const CellOp> make_scale_op(std::int32_t factor);

}  // namespace tessera
