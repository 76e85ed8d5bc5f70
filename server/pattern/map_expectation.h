#pragma once

#include <memory>

#include "server/pattern/area_expectation.h"

namespace tessera {

/// The expectation of cells whose probabilities one map shifts: Basis::varying. `uneven`: as of
/// make_area_expectation.
std::unique_ptr<const AreaExpectation> make_map_expectation(const CellProgram& program,
                                                            const LookMeans& means, std::int32_t slice,
                                                            double uneven = 0);

/// The most that it may take.
std::uint64_t map_expectation_bytes(const StoredMap& map) noexcept;

}  // namespace tessera
