#pragma once

#include <string>
#include <vector>

#include "client/load/assertion.h"
#include "client/load/load_options.h"
#include "client/load/load_run.h"

namespace tessera {

/// What a reader of the figures must know before believing them: a load generator that was late or at its own
/// limit, a closed loop, an early end.
std::vector<std::string> warnings_of(const LoadOutcome& outcome);

/// The whole result, filled histogram buckets included; "tessera_load" counts the versions of the format.
std::string json_report(const LoadOptions& options, const LoadOutcome& outcome,
                        const std::vector<AssertionOutcome>& assertions);

/// The result for a person, some twenty lines.
std::string text_report(const LoadOptions& options, const LoadOutcome& outcome,
                        const std::vector<AssertionOutcome>& assertions);

/// "FAILED  p99<=5ms  (7.210 ms)": one check and what was measured.
std::string assertion_text(const AssertionOutcome& outcome);

}  // namespace tessera
