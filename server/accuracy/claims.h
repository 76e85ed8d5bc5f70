#pragma once

#include <cstdint>

#include "proto/accuracy.pb.h"

namespace tessera {

/// What claims rest on beside the report's rows.
struct ClaimFacts {
    double worst_on_constant = 0;  ///< Codes of linear light, over all filters and situations.
    std::int32_t width = 0, height = 0;
};

/// Adds every claim that can be held against this report, with its figures and whether it holds. A claim
/// whose rows are missing (other textures were measured) is left out.
void add_claims(const ClaimFacts& facts, proto::AccuracyReport& report);

}  // namespace tessera
