#include "client/load/assertion.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tessera {
namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

std::optional<Assertion::Comparison> comparison(std::string_view sign) {
    using enum Assertion::Comparison;
    if (sign == "<") return less;
    if (sign == "<=") return at_most;
    if (sign == ">") return more;
    if (sign == ">=") return at_least;
    if (sign == "==" || sign == "=") return equal;
    if (sign == "!=") return different;
    return std::nullopt;
}

/// What one of `unit` is in the metric's own unit; nothing if it does not fit the metric.
std::optional<double> factor(std::string_view unit, std::string_view metric) {
    if (unit.empty()) return 1;
    if (is_time_metric(metric)) {
        if (unit == "ns") return 1e-6;
        if (unit == "us" || unit == "µs") return 1e-3;
        if (unit == "ms") return 1;
        if (unit == "s") return 1e3;
    } else if (unit == "%" && metric.ends_with("_rate")) {
        return 1e-2;
    }
    return std::nullopt;
}

}  // namespace

Result<Assertion> parse_assertion(std::string_view text) {
    const auto refuse = [&](const std::string& why) {
        return Error{ErrorCode::invalid_input, "assertion '" + std::string{text} + "': " + why};
    };
    const auto sign_begin = text.find_first_of("<>=!");
    if (sign_begin == std::string_view::npos)
        return refuse("write METRIC<=LIMIT, as in p99<=5ms or errors==0");
    const auto sign_end = std::min(text.find_first_not_of("<>=!", sign_begin), text.size());
    const std::string_view sign = text.substr(sign_begin, sign_end - sign_begin);

    Assertion assertion;
    assertion.text = text;
    assertion.metric = trimmed(text.substr(0, sign_begin));
    if (!is_load_metric(assertion.metric))
        return refuse("'" + assertion.metric + "' is not measured; there are " +
                      std::string{load_metric_help()});
    const auto compares = comparison(sign);
    if (!compares) return refuse("'" + std::string{sign} + "' is none of <= < >= > == !=");
    assertion.comparison = *compares;

    const std::string_view limit = trimmed(text.substr(sign_end));
    const auto [end, error] = std::from_chars(limit.data(), limit.data() + limit.size(), assertion.limit);
    if (error != std::errc{} || !std::isfinite(assertion.limit))
        return refuse("a number is missing behind the comparison");
    const std::string_view unit = trimmed(limit.substr(static_cast<std::size_t>(end - limit.data())));
    const auto scale = factor(unit, assertion.metric);
    if (!scale)
        return refuse("the unit '" + std::string{unit} + "' does not fit " + assertion.metric +
                      "; times take ns, us, ms or s, rates take %");
    assertion.limit *= *scale;
    return assertion;
}

AssertionOutcome check(const Assertion& assertion, const LoadTally& tally) {
    AssertionOutcome outcome{assertion, load_metric(tally, assertion.metric), false};
    if (!outcome.actual) return outcome;
    const double actual = *outcome.actual, limit = assertion.limit;
    switch (assertion.comparison) {
        using enum Assertion::Comparison;
        case less:
            outcome.holds = actual < limit;
            break;
        case at_most:
            outcome.holds = actual <= limit;
            break;
        case more:
            outcome.holds = actual > limit;
            break;
        case at_least:
            outcome.holds = actual >= limit;
            break;
        case equal:
            outcome.holds = actual == limit;
            break;
        case different:
            outcome.holds = actual != limit;
            break;
    }
    return outcome;
}

}  // namespace tessera
