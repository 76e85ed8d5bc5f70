#include "server/http/media_type.h"

#include <charconv>

#include "server/http/field_values.h"

namespace tessera {
namespace {

/// 0 to 1; a weight that is no number counts as 0.
double weight_of(std::string_view parameters) {
    while (!parameters.empty()) {
        const std::string_view parameter = next_element(parameters, ';');
        if (!parameter.starts_with("q=") && !parameter.starts_with("Q=")) continue;
        double weight = 0;
        const auto [end, failure] =
            std::from_chars(parameter.data() + 2, parameter.data() + parameter.size(), weight);
        const bool whole = failure == std::errc{} && end == parameter.data() + parameter.size();
        return whole && weight >= 0 && weight <= 1 ? weight : 0;
    }
    return 1;
}

/// How closely a media range names a coding: 3 by its type, 2 as application/*, 1 as */*, 0 not at all.
int closeness(std::string_view range, WireCoding coding) {
    if (wire_coding_of(range) == coding) return 3;
    return equals_ignoring_case(range, "application/*") ? 2 : range == "*/*" ? 1 : 0;
}

double weight_in(std::string_view accept, WireCoding coding) {
    int closest = 0;
    double weight = 0;
    while (!accept.empty()) {
        std::string_view parameters = next_element(accept);
        const std::string_view range = next_element(parameters, ';');
        const int close = closeness(range, coding);
        if (close <= closest) continue;
        closest = close;
        weight = weight_of(parameters);
    }
    return weight;
}

}  // namespace

std::optional<WireCoding> wire_coding_of(std::string_view content_type) {
    const std::string_view type = next_element(content_type, ';');
    if (equals_ignoring_case(type, "application/json")) return WireCoding::json;
    if (equals_ignoring_case(type, "application/x-protobuf") ||
        equals_ignoring_case(type, "application/protobuf"))
        return WireCoding::protobuf;
    return std::nullopt;
}

std::optional<WireCoding> accepted_coding(std::string_view accept, WireCoding own) {
    if (trimmed(accept).empty()) return own;
    const WireCoding other = own == WireCoding::json ? WireCoding::protobuf : WireCoding::json;
    const double liked = weight_in(accept, own), other_liked = weight_in(accept, other);
    if (liked <= 0 && other_liked <= 0) return std::nullopt;
    return liked >= other_liked ? own : other;
}

}  // namespace tessera
