#pragma once

#include <memory>

#include "server/pattern/area_expectation.h"

namespace tessera {

/// The expectation of cells whose probabilities one map shifts: Basis::varying.
std::unique_ptr<const AreaExpectation> make_map_expectation(const CellProgram& program,
                                                            const LookMeans& means, std::int32_t slice);

}  // namespace tessera
