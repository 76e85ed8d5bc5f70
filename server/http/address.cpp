#include "server/http/address.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>

#include "shared/page/parameter.h"

namespace tessera {
namespace {

constexpr std::uint64_t out_of_range = std::numeric_limits<std::uint64_t>::max();

Refusal malformed(std::string why) { return {400, std::move(why), false}; }

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

Parsed<std::string> decode(std::string_view text) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            const int high = i + 1 < text.size() ? hex_digit(text[i + 1]) : -1;
            const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
            if (high < 0 || low < 0) return malformed("'%' is followed by two hexadecimal digits");
            c = static_cast<char>(high * 16 + low);
            i += 2;
            if (c < ' ' || c == '\x7f' || c == '/' || c == '\\')
                return malformed("the address hides a separator or a byte outside ASCII");
        }
        decoded.push_back(c);
    }
    return decoded;
}

/// A decimal number without sign or leading zeros, so that a page has one address. Numbers beyond every
/// extent, and negative ones, are well formed and out of range.
std::optional<std::uint64_t> number(std::string_view text) {
    const bool negative = text.starts_with('-');
    if (negative) text.remove_prefix(1);
    if (text.empty() || !std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }) ||
        (text.size() > 1 && text.front() == '0'))
        return std::nullopt;
    std::uint64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || negative) return out_of_range;
    return value;
}

/// A decimal number within ±most, which may be negative; −0 is no number.
std::optional<std::int64_t> signed_number(std::string_view text, std::int64_t most) {
    const bool negative = text.starts_with('-');
    const auto magnitude = number(negative ? text.substr(1) : text);
    if (!magnitude || *magnitude > static_cast<std::uint64_t>(most) || (negative && *magnitude == 0))
        return std::nullopt;
    return negative ? -static_cast<std::int64_t>(*magnitude) : static_cast<std::int64_t>(*magnitude);
}

std::optional<PageAddress::Pin> pin_of(std::string_view text) {
    const std::size_t dash = text.find('-');
    if (!text.starts_with('r') || dash == std::string_view::npos) return std::nullopt;
    const auto revision = number(text.substr(1, dash - 1));
    const std::string_view fingerprint = text.substr(dash + 1);
    if (!revision || fingerprint.size() != 16 ||
        !std::all_of(fingerprint.begin(), fingerprint.end(), [](char c) { return hex_digit(c) >= 0; }))
        return std::nullopt;
    return PageAddress::Pin{*revision, std::string{fingerprint}};
}

}  // namespace

void throw_exception_from_error(const Refusal& refusal, const boost::source_location&) {
    throw std::logic_error{refusal.why};
}

Parsed<std::vector<std::string>> path_segments(std::string_view path) {
    std::vector<std::string> segments;
    for (std::size_t begin = 1; begin <= path.size();) {
        const std::size_t end = std::min(path.find('/', begin), path.size());
        auto segment = decode(path.substr(begin, end - begin));
        if (!segment) return segment.error();
        if (*segment == "." || *segment == "..") return malformed("the address has a relative segment");
        segments.push_back(std::move(*segment));
        begin = end + 1;
    }
    if (segments.empty()) segments.emplace_back();
    return segments;
}

bool is_page_address(const std::vector<std::string>& segments) noexcept {
    return segments.front() == "scenes" && (segments.size() == 5 || segments.size() == 6);
}

Parsed<PageAddress> page_address(const std::vector<std::string>& segments) {
    PageAddress address;
    address.scene = segments[1];
    if (segments.size() == 6) {
        address.pin = pin_of(segments[2]);
        if (!address.pin)
            return malformed("a page at a revision is /scenes/{id}/r{revision}-{fingerprint}/…");
    }
    const auto numbers = segments.end() - 3;
    const std::string_view last = segments.back();
    const std::size_t dot = last.find('.');
    const auto z = number(numbers[0]), x = number(numbers[1]), y = number(last.substr(0, dot));
    const auto format = dot == std::string_view::npos ? std::nullopt : page_format(last.substr(dot + 1));
    if (!z || !x || !y) return malformed("z, x and y are decimal numbers: /scenes/{id}/{z}/{x}/{y}.png");
    if (!format) return malformed("a page's address ends in .png, .jpg, .webp or .rgba");
    address.z = *z;
    address.x = *x;
    address.y = *y;
    address.format = *format;
    return address;
}

Parsed<PageQuery> page_query(std::string_view query) {
    PageQuery result;
    bool has_gutter = false, has_accuracy = false, has_max_error = false, has_channels = false,
         has_slice = false, has_step = false, has_parameter = false;
    while (!query.empty()) {
        const std::size_t end = std::min(query.find('&'), query.size());
        const std::string_view item = query.substr(0, end);
        const std::size_t equals = std::min(item.find('='), item.size());
        const std::string_view name = item.substr(0, equals);
        const std::string_view value = item.substr(std::min(equals + 1, item.size()));
        query.remove_prefix(std::min(end + 1, query.size()));
        if (name == "gutter") {
            const auto texels = number(value);
            if (!texels || *texels > static_cast<std::uint64_t>(max_gutter_texels))
                return malformed("gutter: texels from 0 to " + std::to_string(max_gutter_texels));
            if (std::exchange(has_gutter, true)) return malformed("gutter: is given twice");
            result.gutter = static_cast<std::uint8_t>(*texels);
        } else if (name == "accuracy") {
            const auto accuracy = accuracy_named(value);
            if (!accuracy) return malformed("accuracy: exact, high or fast");
            if (std::exchange(has_accuracy, true)) return malformed("accuracy: is given twice");
            result.accuracy = *accuracy;
        } else if (name == "max_error") {
            const auto limit = error_limit_named(value);
            if (!limit) return malformed("max_error: 8-bit codes from 0 to 255, such as 0.5");
            if (std::exchange(has_max_error, true)) return malformed("max_error: is given twice");
            result.max_error = *limit;
        } else if (name == "channels") {
            const auto channels = channel_set_named(value);
            if (!channels) return malformed("channels: albedo, normal, roughness, height or moments");
            if (std::exchange(has_channels, true)) return malformed("channels: is given twice");
            result.channels = *channels;
        } else if (name == "slice") {
            const auto slice = signed_number(value, max_slice);
            if (!slice) return malformed("slice: an integer from -2^40 to 2^40");
            if (std::exchange(has_slice, true)) return malformed("slice: is given twice");
            result.slice = *slice;
        } else if (name == "step") {
            const auto step = signed_number(value, max_step);
            if (!step) return malformed("step: an integer from -2^62 to 2^62");
            if (std::exchange(has_step, true)) return malformed("step: is given twice");
            result.step = *step;
        } else if (name == "parameter") {
            const auto parameter = parameter_named(value);
            if (!parameter) return malformed("parameter: a number from 0 to 1, such as 0.25");
            if (std::exchange(has_parameter, true)) return malformed("parameter: is given twice");
            result.parameter = *parameter;
        } else {
            return malformed(
                "unknown parameter; pages take gutter, accuracy, max_error, channels, slice, step "
                "and parameter");
        }
    }
    if (result.max_error) result.accuracy = Accuracy::high;
    return result;
}

std::string PageQuery::canonical() const {
    std::string text;
    const auto add = [&text](std::string_view name, std::string_view value) {
        text += text.empty() ? '?' : '&';
        text.append(name).append(1, '=').append(value);
    };
    if (gutter != 0) add("gutter", std::to_string(gutter));
    if (accuracy != Accuracy::high) add("accuracy", name_of(accuracy));
    if (max_error) add("max_error", text_of(*max_error));
    if (channels != ChannelSet::albedo) add("channels", name_of(channels));
    if (slice != 0) add("slice", std::to_string(slice));
    if (step != 0) add("step", std::to_string(step));
    if (parameter != 0) add("parameter", text_of_parameter(parameter));
    return text;
}

}  // namespace tessera
