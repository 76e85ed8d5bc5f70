#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "client/load/load_tally.h"
#include "shared/result/result.h"

namespace tessera {

/// What a run must hold to, as in `p99<=5ms`.
struct Assertion {
    enum class Comparison { less, at_most, more, at_least, equal, different };
    std::string text;  ///< As it was written.
    std::string metric;
    Comparison comparison = Comparison::at_most;
    double limit = 0;  ///< Milliseconds for times, 0 to 1 for shares.
};

struct AssertionOutcome {
    Assertion assertion;
    std::optional<double> actual;
    bool holds = false;  ///< False where there is no value: nothing measured is nothing shown.
};

/// METRIC, one of <= < >= > == !=, and a number with a unit where there is one: ns, us, ms, s for times (ms
/// if none), % for shares. Spaces do not matter. Anything else is `invalid_input`, and the detail lists the
/// metrics.
Result<Assertion> parse_assertion(std::string_view text);

AssertionOutcome check(const Assertion& assertion, const LoadTally& tally);

}  // namespace tessera
